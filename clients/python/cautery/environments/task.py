# SPDX-License-Identifier: Apache-2.0
"""The base class of all tasks: the interface of Gymnasium's environments over simulated tissue."""

from __future__ import annotations

import abc
from typing import Any, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ..errors import Error
from .spaces import Box
from .tissue import RemoteTissue, Seen, Tissue, ToolCommand

Observation = npt.NDArray[np.float32]
Picture = npt.NDArray[np.uint8]

_TISSUES = (1 << 31) - 1  # number of seeds of a scene


class Task(abc.ABC):
    """Gymnasium's interface: `reset`, `step`, `close`, `action_space`, `observation_space`.

    A task defines five functions. `_begin` chooses the scene of an episode. `_act` applies an action. `_observe` returns
    the observation. `_judge` returns the reward and whether the episode has ended. `_draw` returns the picture.

    `url` is the address of a daemon. By default the task starts its own daemon, from the program `daemon` and with
    `settings`. `tissue` simulates the tissue instead of a daemon; the package cautery_core has such a class.
    `tissue_count` is the number of different tissues, of which each episode draws one; by default each episode has
    another tissue. `steps_most` is the largest number of steps of an episode. Equal seeds and actions give equal
    episodes.
    """

    metadata: Mapping[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 15}
    reward_range = (-np.inf, np.inf)
    spec = None
    steps_usual: int  # largest number of steps of an episode, unless `steps_most` is given
    ticks: int  # ticks of the simulation in a step
    scalars: Sequence[str] = ("exposure",)  # channels of the vertices that the task needs
    action_space: Box  # defined by each task
    observation_space: Box

    def __init__(self, url: str | None = None, *, daemon: str | None = None, render_mode: str | None = None,
                 tissue: Tissue | None = None, tissue_count: int = _TISSUES, steps_most: int | None = None,
                 **settings: object) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"render_mode {render_mode!r} is not one of {self.metadata['render_modes']}")
        self._steps_most = self.steps_usual if steps_most is None else steps_most
        if not 1 <= tissue_count <= _TISSUES or self._steps_most < 1:
            raise ValueError(f"tissue_count must be 1 to {_TISSUES}, and steps_most at least 1")
        self.render_mode = render_mode
        self.action_space, self.observation_space = self._spaces()
        self._random = np.random.default_rng()
        self._tissue_count = tissue_count
        self._over = True
        self._tissue: Tissue = RemoteTissue(url, daemon, **settings) if tissue is None else tissue

    @property
    def unwrapped(self) -> Task:
        """This environment."""
        return self

    @property
    def np_random(self) -> np.random.Generator:
        """The generator of all random numbers."""
        return self._random

    def close(self) -> None:
        """Ends the session, and the daemon if this task started it."""
        self._over = True
        self._tissue.close()

    def __enter__(self) -> Task:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ---- episodes
    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None,
              ) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode. `seed` is for this and all following episodes. The task describes `options`."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        self._over = True  # until the episode has begun
        self._begin(options or {})
        self._steps = 0
        self._over = False
        return self._observe(), self._info()

    def step(self, action: npt.ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Applies an action and advances the tissue. The task describes action, observation and reward."""
        if self._over:
            raise Error("the episode has ended, or no episode has begun: call reset")
        wanted = np.asarray(action, float)
        if wanted.shape != self.action_space.shape or not np.isfinite(wanted).all():
            raise ValueError(f"an action must have {self.action_space.shape[0]} finite numbers")
        before = self._state
        self._go(self._act(wanted.clip(-1, 1)))
        self._steps += 1
        reward, terminated = self._judge(before)
        truncated = not terminated and self._steps >= self._steps_most
        self._over = terminated or truncated
        return self._observe(), float(reward), terminated, truncated, self._info()

    def render(self) -> Picture | None:
        """Returns a picture, (height, width, 3), or None without a render mode."""
        return None if self.render_mode is None else self._draw()

    # ---- for the tasks
    def _draw_tissue(self) -> int:
        """Draws the seed of a tissue, 1 to `tissue_count`."""
        return 1 + int(self._random.integers(0, _TISSUES)) % self._tissue_count

    def _go(self, commands: Sequence[ToolCommand], ticks: int | None = None) -> None:
        """Commands the tools and advances the tissue by `ticks` (default: the ticks of a step)."""
        self._state: Seen = self._tissue.step(commands, self.ticks if ticks is None else ticks)

    def _faces_of(self, layer: int) -> npt.NDArray[np.int64]:
        """Returns the faces of the layer with this index in the scene."""
        return np.flatnonzero(self._tissue.face_layers == layer)

    def _most_exposed(self, part: npt.NDArray[np.int64]) -> float:
        """Returns the largest exposure at the present faces of `part`; 1 if all faces have parted."""
        held = self._tissue.faces[part][~self._state.removed[part]]
        return float(self._state.scalars["exposure"][held].max(initial=0)) if len(held) else 1.0

    # ---- what makes a task
    @abc.abstractmethod
    def _spaces(self) -> tuple[Box, Box]:
        """Returns the spaces of actions and of observations."""

    @abc.abstractmethod
    def _begin(self, options: Mapping[str, Any]) -> None:
        """Draws the random values of an episode, begins its scene, and sets `_state` by `_go`."""

    @abc.abstractmethod
    def _act(self, action: npt.NDArray[np.float64]) -> list[ToolCommand]:
        """Returns the commands of the tools in a step. The action is within -1 and 1."""

    @abc.abstractmethod
    def _observe(self) -> Observation:
        """Returns the observation as a new array."""

    @abc.abstractmethod
    def _judge(self, before: Seen) -> tuple[float, bool]:
        """Returns the reward of the step from `before` to `_state`, and whether the episode has ended."""

    @abc.abstractmethod
    def _info(self) -> dict[str, Any]:
        """Returns further values for people and tests."""

    @abc.abstractmethod
    def _draw(self) -> Picture:
        """Returns a picture."""


def is_divided(faces: npt.NDArray[np.int32], ends: tuple[set[int], set[int]]) -> bool:
    """Returns whether no chain of faces leads from the vertices of one end to those of the other end."""
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
