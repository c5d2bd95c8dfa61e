# SPDX-License-Identifier: Apache-2.0
"""A band of fascia lies over a second sheet. Part the band from side to side, and damage nothing below."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from .spaces import Box
from .task import Observation, Picture, Task, is_divided
from .tissue import Seen, ToolCommand

LENGTH_M, WIDTH_M = 0.03, 0.012  # of the band, along x and y
CELLS = (30, 12)
GAP_M = 0.004  # from the band down to the sheet
HOT_RADIUS_M = 0.0008
TEMPERATURE_C = 700
REACH_M = (0.012, 0.012, 0.008)  # reach of the tip: to both sides of the middle of the band, and above it
DEPTH_M = 0.006  # reach of the tip below the band
MOVE_M = 0.0005  # largest motion of the tip in a step, along each axis
TICKS = 4  # of the simulation in a step
STEPS_MOST = 200  # of an episode
COLUMNS = 12  # columns across the band, each observed as whole or parted

_PARTED_REWARD, _BURNT_REWARD, _STEP_REWARD, _DONE_REWARD = 1.0, -0.5, -0.005, 10.0


def _sheet(name: str, height_m: float) -> dict[str, Any]:
    return {"source": "sheet", "name": name, "size_m": [LENGTH_M, WIDTH_M], "cells": list(CELLS),
            "translate_m": [0, 0, height_m]}


def _layer(name: str) -> dict[str, Any]:
    return {"kind": "fascia", "name": name, "mesh": name, "thickness_m": 0.0005, "density_kg_m3": 1100,
            "limit_stiffness_pa": 1e6, "limit": "target", "target": [0.9, 0.9, 0], "ignition_c": 120,
            "ignition_spread_c": 20, "absorption_per_s": 4}


def scene(seed: int) -> dict[str, Any]:
    """Returns the scene of the task. `seed` decides where the tissue is tougher."""
    ends = [{"kind": "box", "layer": "band", "least_m": [x - 1e-4, -1, -1], "most_m": [x + 1e-4, 1, 1]}
            for x in (-LENGTH_M / 2, LENGTH_M / 2)]
    tool = {"name": "hook", "shape": "sphere", "hot_radius_m": HOT_RADIUS_M, "temperature_c": TEMPERATURE_C,
            "grid_step_m": 0.0004, "position_m": [0, 0, REACH_M[2]]}
    return {"name": "part-band", "description": "A band over a sheet.", "seed": seed, "parting": "elements",
            "meshes": [_sheet("band", 0.0), _sheet("below", -GAP_M)], "layers": [_layer("band"), _layer("below")],
            "pins": [*ends, {"kind": "rim", "layer": "below"}], "tools": [tool]}


class PartBand(Task):
    """Part the band, and damage nothing below it. `cautery.environments.Task` describes the parameters.

    An action has four numbers from -1 to 1: the motion of the tip along x, y and z (1 is 0.5 mm), and the energy, which
    is on above 0. An observation has: the position of the tip (3, over its reach); whether energy is on; for each of 12
    columns across the band, whether a face has parted; the largest exposure of the band, and of the sheet below (at 1 a
    face parts). Rewards: 1 for each column that parts; 10 for the whole band; -0.5 for each face below that parts; -0.005
    for each step. An episode terminates when the band or a face below has parted, and is truncated after 200 steps.

    `reset(options={"tip_m": [x, y, z]})` sets the first position of the tip. `render()` returns the band from above,
    (60, 150, 3).
    """

    steps_usual, ticks = STEPS_MOST, TICKS

    def _spaces(self) -> tuple[Box, Box]:
        return Box(-np.ones(4), np.ones(4)), Box(np.r_[-np.ones(3), np.zeros(COLUMNS + 3)], np.ones(COLUMNS + 6))

    # ---- an episode
    def _begin(self, options: Mapping[str, Any]) -> None:
        place = self._random.uniform((-0.006, -0.008, 0.003), (0.006, 0.008, 0.006))
        toughness = self._draw_tissue()
        if "tip_m" in options:
            place = np.asarray(options["tip_m"], float)
        self._tissue.begin(scene(toughness), self.scalars)
        faces, rest = self._tissue.faces, self._tissue.rest
        self._band, self._below = self._parts = [self._faces_of(layer) for layer in (0, 1)]
        across = rest[faces[self._band]].mean(axis=1)[:, 1] / WIDTH_M + 0.5
        self._column = (across * COLUMNS).astype(int).clip(0, COLUMNS - 1)
        band = np.unique(faces[self._band])
        sides = rest[band][:, 0] / LENGTH_M
        self._ends = (set(band[sides < -0.499].tolist()), set(band[sides > 0.499].tolist()))
        self._tip, self._energy = place, False
        self._go(self._commands())

    def _commands(self) -> list[ToolCommand]:
        return [ToolCommand("hook", self._tip, energized=self._energy)]

    def _act(self, action: npt.NDArray[np.float64]) -> list[ToolCommand]:
        least = np.array([-REACH_M[0], -REACH_M[1], -DEPTH_M])
        self._tip = (self._tip + MOVE_M * action[:3]).clip(least, REACH_M)
        self._energy = bool(action[3] > 0)
        return self._commands()

    def _judge(self, before: Seen) -> tuple[float, bool]:
        burnt, parted = self._burnt(self._state), self._is_parted()
        gone = int(self._columns_left(before).sum() - self._columns_left(self._state).sum())
        reward = (_PARTED_REWARD * gone + _BURNT_REWARD * (burnt - self._burnt(before)) + _STEP_REWARD
                  + _DONE_REWARD * (parted and not burnt))
        return reward, parted or burnt > 0

    # ---- what is seen
    def _columns_left(self, state: Seen) -> npt.NDArray[np.int64]:
        """Returns 1 for each whole column, 0 for a column with a parted face. (COLUMNS,)"""
        left = np.ones(COLUMNS, np.int64)
        left[self._column[state.removed[self._band]]] = 0
        return left

    def _burnt(self, state: Seen) -> int:
        return int(state.removed[self._below].sum())

    def _is_parted(self) -> bool:
        faces = self._tissue.faces[self._band][~self._state.removed[self._band]]
        return bool((self._columns_left(self._state) == 0).all()) and is_divided(faces, self._ends)

    def _observe(self) -> Observation:
        most = [self._most_exposed(part) for part in self._parts]
        tip = self._tip / np.array([*REACH_M[:2], max(REACH_M[2], DEPTH_M)])
        left = self._columns_left(self._state)
        return np.r_[tip, self._energy, 1 - left, most].clip(-1, 1).astype(np.float32)

    def _info(self) -> dict[str, Any]:
        return {"tick": self._state.tick, "columns_parted": int((self._columns_left(self._state) == 0).sum()),
                "faces_burnt_below": self._burnt(self._state), "parted": self._is_parted(), "tip_m": self._tip.copy()}

    def _draw(self) -> Picture:
        picture = np.full((60, 150, 3), 255, np.uint8)
        middles = self._state.positions[self._tissue.faces[self._band]].mean(axis=1)
        colours = np.where(self._state.removed[self._band][:, None], (40, 20, 20), (220, 150, 130))
        for (x, y, _), colour in zip(middles, colours):
            column, row = int((x / LENGTH_M + 0.5) * 149), int((y / WIDTH_M + 0.5) * 59)
            picture[max(row - 2, 0):row + 3, max(column - 2, 0):column + 3] = colour
        column, row = int((self._tip[0] / LENGTH_M + 0.5) * 149), int((self._tip[1] / WIDTH_M + 0.5) * 59)
        picture[max(row - 1, 0):max(row + 2, 0), max(column - 1, 0):max(column + 2, 0)] = (220, 60, 0)
        return picture
