# SPDX-License-Identifier: Apache-2.0
"""A band of fascia lies over a second sheet. Part the band from side to side, and burn nothing below."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from ..errors import Error
from .spaces import Box
from .tissue import RemoteTissue, Seen, Tissue

Observation = npt.NDArray[np.float32]

LENGTH_M, WIDTH_M = 0.03, 0.012  # of the band, along x and y
CELLS = (30, 12)
GAP_M = 0.004  # from the band down to the sheet
HOT_RADIUS_M = 0.0008
TEMPERATURE_C = 700
REACH_M = (0.012, 0.012, 0.008)  # of the tip: to both sides of the band's middle, and above it
DEPTH_M = 0.006  # and below
MOVE_M = 0.0005  # of the tip in a step, along each axis, at most
TICKS = 4  # of the simulation in a step
STEPS_MOST = 200  # of an episode
COLUMNS = 12  # across the band: whether each is whole

_TISSUES = (1 << 31) - 1  # seeds of a scene
_PARTED_REWARD, _BURNT_REWARD, _STEP_REWARD, _DONE_REWARD = 1.0, -0.5, -0.005, 10.0


def _sheet(name: str, height_m: float) -> dict[str, Any]:
    return {"source": "sheet", "name": name, "size_m": [LENGTH_M, WIDTH_M], "cells": list(CELLS),
            "translate_m": [0, 0, height_m]}


def _layer(name: str) -> dict[str, Any]:
    return {"kind": "fascia", "name": name, "mesh": name, "thickness_m": 0.0005, "density_kg_m3": 1100,
            "limit_stiffness_pa": 1e6, "limit": "target", "target": [0.9, 0.9, 0], "ignition_c": 120,
            "ignition_spread_c": 20, "absorption_per_s": 4}


def scene(seed: int) -> dict[str, Any]:
    """The task's scene. `seed`: of where the tissue is tougher."""
    ends = [{"kind": "box", "layer": "band", "least_m": [x - 1e-4, -1, -1], "most_m": [x + 1e-4, 1, 1]}
            for x in (-LENGTH_M / 2, LENGTH_M / 2)]
    tool = {"name": "hook", "shape": "sphere", "hot_radius_m": HOT_RADIUS_M, "temperature_c": TEMPERATURE_C,
            "grid_step_m": 0.0004, "position_m": [0, 0, REACH_M[2]]}
    return {"name": "part-band", "description": "A band over a sheet.", "seed": seed, "parting": "elements",
            "meshes": [_sheet("band", 0.0), _sheet("below", -GAP_M)], "layers": [_layer("band"), _layer("below")],
            "pins": [*ends, {"kind": "rim", "layer": "below"}], "tools": [tool]}


def _is_parted(faces: npt.NDArray[np.int32], ends: tuple[set[int], set[int]]) -> bool:
    """Whether no chain of faces leads from one end's vertices to the other's."""
    neighbours: dict[int, set[int]] = {}
    for face in faces.tolist():
        for vertex in face:
            neighbours.setdefault(vertex, set()).update(face)
    reached, waiting = set(ends[0]), list(ends[0])
    while waiting:
        for vertex in neighbours.get(waiting.pop(), ()):
            if vertex not in reached:
                reached.add(vertex)
                waiting.append(vertex)
    return not reached & ends[1]


class PartBand:
    """Gymnasium's interface: `reset`, `step`, `close`, `action_space`, `observation_space`.

    An action has four numbers from -1 to 1: how the tip moves along x, y and z (1 is 0.5 mm), and the energy, which is
    on above 0. An observation: the tip's place (3, in shares of its reach), whether energy is on, whether a face has
    parted in each of 12 columns across the band, and the largest exposure of the band and of the sheet below (1 parts).
    Rewards: 1 for each column that parts, 10 for the whole band, -0.5 for each face below that parts, -0.005 a step.
    It is terminated once the band is parted or a face below is, and truncated after 200 steps.

    `url`: of a daemon; by default the task starts one of its own (`daemon`: its program, `settings`: its further ones).
    `tissue`: where the tissue is simulated in the place of a daemon; the package cautery_core has one in process.
    `tissue_count`: of how many tissues each episode draws one; by default each episode has another. `steps_most`: of an
    episode. Equal seeds and actions make equal episodes. `render()` returns a picture of the band from above, (H, W, 3).
    """

    metadata: Mapping[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 15}
    reward_range = (-np.inf, np.inf)
    spec = None

    def __init__(self, url: str | None = None, *, daemon: str | None = None, render_mode: str | None = None,
                 tissue: Tissue | None = None, tissue_count: int = _TISSUES, steps_most: int = STEPS_MOST,
                 **settings: object) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"{render_mode!r} is none of {self.metadata['render_modes']}")
        if not 1 <= tissue_count <= _TISSUES or steps_most < 1:
            raise ValueError(f"tissue_count is 1 to {_TISSUES}, and steps_most 1 at least")
        self.render_mode = render_mode
        self.action_space = Box(-np.ones(4), np.ones(4))
        self.observation_space = Box(np.r_[-np.ones(3), np.zeros(COLUMNS + 3)], np.ones(COLUMNS + 6))
        self._random = np.random.default_rng()
        self._tissue_count, self._steps_most = tissue_count, steps_most
        self._over = True
        self._tissue: Tissue = RemoteTissue(url, daemon, **settings) if tissue is None else tissue

    @property
    def unwrapped(self) -> PartBand:
        """Itself."""
        return self

    @property
    def np_random(self) -> np.random.Generator:
        """What chances are drawn from."""
        return self._random

    def close(self) -> None:
        """Ends the session, and the daemon if it is the task's own."""
        self._tissue.close()

    # ---- episodes
    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None,
              ) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode. `seed`: of it and all that follow; `options`: {"tip_m": [x, y, z]} for where it begins."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        place = self._random.uniform((-0.006, -0.008, 0.003), (0.006, 0.008, 0.006))
        toughness = 1 + int(self._random.integers(0, _TISSUES)) % self._tissue_count
        if options and "tip_m" in options:
            place = np.asarray(options["tip_m"], float)
        self._begin(toughness)
        self._tip = place
        self._energy = False
        self._steps = 0
        self._over = False
        self._state = self._go()
        self._left = self._columns_left(self._state)
        return self._observe(), self._info()

    def step(self, action: npt.ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Moves the tip, and steps the tissue on. See the class for action, observation and reward."""
        if self._over:
            raise Error("the episode is over, or none has begun: call reset")
        wanted = np.asarray(action, float)
        if wanted.shape != self.action_space.shape or not np.isfinite(wanted).all():
            raise ValueError(f"an action has {self.action_space.shape[0]} finite numbers")
        wanted = wanted.clip(-1, 1)
        least = np.array([-REACH_M[0], -REACH_M[1], -DEPTH_M])
        self._tip = (self._tip + MOVE_M * wanted[:3]).clip(least, REACH_M)
        self._energy = bool(wanted[3] > 0)
        before_left, before_burnt = self._left, self._burnt(self._state)
        self._state = self._go()
        self._left = self._columns_left(self._state)
        self._steps += 1
        burnt = self._burnt(self._state)
        parted = self._is_parted()
        gone = int((before_left > 0).sum() - (self._left > 0).sum())
        reward = (_PARTED_REWARD * gone + _BURNT_REWARD * (burnt - before_burnt) + _STEP_REWARD
                  + _DONE_REWARD * (parted and not burnt))
        terminated = parted or burnt > 0
        truncated = not terminated and self._steps >= self._steps_most
        self._over = terminated or truncated
        return self._observe(), float(reward), terminated, truncated, self._info()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """The band from above, (60, 150, 3); None without a render mode."""
        if self.render_mode is None:
            return None
        picture = np.full((60, 150, 3), 255, np.uint8)
        middles = self._state.positions[self._tissue.faces[self._band]].mean(axis=1)
        colours = np.where(self._state.removed[self._band][:, None], (40, 20, 20), (220, 150, 130))
        for (x, y, _), colour in zip(middles, colours):
            column, row = int((x / LENGTH_M + 0.5) * 149), int((y / WIDTH_M + 0.5) * 59)
            picture[max(row - 2, 0):row + 3, max(column - 2, 0):column + 3] = colour
        column, row = int((self._tip[0] / LENGTH_M + 0.5) * 149), int((self._tip[1] / WIDTH_M + 0.5) * 59)
        picture[max(row - 1, 0):max(row + 2, 0), max(column - 1, 0):max(column + 2, 0)] = (220, 60, 0)
        return picture

    # ---- the session
    def _begin(self, toughness: int) -> None:
        self._tissue.begin(scene(toughness))
        faces, rest = self._tissue.faces, self._tissue.rest
        self._parts = [np.flatnonzero(self._tissue.face_layers == layer) for layer in (0, 1)]
        self._band, self._below = self._parts
        across = rest[faces[self._band]].mean(axis=1)[:, 1] / WIDTH_M + 0.5
        self._column = (across * COLUMNS).astype(int).clip(0, COLUMNS - 1)
        band = np.unique(faces[self._band])
        sides = rest[band][:, 0] / LENGTH_M
        self._ends = (set(band[sides < -0.499].tolist()), set(band[sides > 0.499].tolist()))

    def _go(self) -> Seen:
        """The tool goes to the tip's place, and time goes on by a step's ticks."""
        return self._tissue.step(self._tip, self._energy, TICKS)

    # ---- what is seen
    def _columns_left(self, state: Seen) -> npt.NDArray[np.int64]:
        """1 for each column that is whole, 0 once a face of it has parted. (COLUMNS,)"""
        left = np.ones(COLUMNS, np.int64)
        left[self._column[state.removed[self._band]]] = 0
        return left

    def _burnt(self, state: Seen) -> int:
        return int(state.removed[self._below].sum())

    def _is_parted(self) -> bool:
        faces = self._tissue.faces[self._band][~self._state.removed[self._band]]
        return bool((self._left == 0).all()) and _is_parted(faces, self._ends)

    def _most_exposed(self, part: npt.NDArray[np.int64]) -> float:
        """The largest exposure at the faces of a part that still hold; 1 if none does."""
        held = self._tissue.faces[part][~self._state.removed[part]]
        return float(self._state.exposure[held].max(initial=0)) if len(held) else 1.0

    def _observe(self) -> Observation:
        most = [self._most_exposed(part) for part in self._parts]
        tip = self._tip / np.array([*REACH_M[:2], max(REACH_M[2], DEPTH_M)])
        return np.r_[tip, self._energy, 1 - self._left, most].clip(-1, 1).astype(np.float32)

    def _info(self) -> dict[str, Any]:
        return {"tick": self._state.tick, "columns_parted": int((self._left == 0).sum()),
                "faces_burnt_below": self._burnt(self._state), "parted": self._is_parted(), "tip_m": self._tip.copy()}
