# SPDX-License-Identifier: Apache-2.0
"""What all tasks share: the interface of Gymnasium's environments over some tissue."""

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

_TISSUES = (1 << 31) - 1  # seeds of a scene


class Task(abc.ABC):
    """Gymnasium's interface: `reset`, `step`, `close`, `action_space`, `observation_space`.

    A task says in `_begin` which scene an episode has, in `_act` what an action does, in `_observe` what is seen, in
    `_judge` the reward and whether the episode has ended, and in `_draw` the picture.

    `url`: of a daemon; by default the task starts one of its own (`daemon`: its program, `settings`: its further ones).
    `tissue`: where the tissue is simulated in the place of a daemon; the package cautery_core has one in process.
    `tissue_count`: of how many tissues each episode draws one; by default each episode has another. `steps_most`: of an
    episode. Equal seeds and actions make equal episodes.
    """

    metadata: Mapping[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 15}
    reward_range = (-np.inf, np.inf)
    spec = None
    steps_usual: int  # of an episode at most, unless `steps_most` says otherwise
    ticks: int  # of the simulation in a step
    scalars: Sequence[str] = ("exposure",)  # channels of the vertices that the task looks at
    action_space: Box  # each task's own
    observation_space: Box

    def __init__(self, url: str | None = None, *, daemon: str | None = None, render_mode: str | None = None,
                 tissue: Tissue | None = None, tissue_count: int = _TISSUES, steps_most: int | None = None,
                 **settings: object) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"{render_mode!r} is none of {self.metadata['render_modes']}")
        self._steps_most = self.steps_usual if steps_most is None else steps_most
        if not 1 <= tissue_count <= _TISSUES or self._steps_most < 1:
            raise ValueError(f"tissue_count is 1 to {_TISSUES}, and steps_most 1 at least")
        self.render_mode = render_mode
        self.action_space, self.observation_space = self._spaces()
        self._random = np.random.default_rng()
        self._tissue_count = tissue_count
        self._over = True
        self._tissue: Tissue = RemoteTissue(url, daemon, **settings) if tissue is None else tissue

    @property
    def unwrapped(self) -> Task:
        """Itself."""
        return self

    @property
    def np_random(self) -> np.random.Generator:
        """What chances are drawn from."""
        return self._random

    def close(self) -> None:
        """Ends the session, and the daemon if it is the task's own."""
        self._over = True
        self._tissue.close()

    def __enter__(self) -> Task:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ---- episodes
    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None,
              ) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode. `seed`: of it and all that follow; `options`: see the task."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        self._over = True  # until it has begun
        self._begin(options or {})
        self._steps = 0
        self._over = False
        return self._observe(), self._info()

    def step(self, action: npt.ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Does the action, and steps the tissue on. See the task for action, observation and reward."""
        if self._over:
            raise Error("the episode is over, or none has begun: call reset")
        wanted = np.asarray(action, float)
        if wanted.shape != self.action_space.shape or not np.isfinite(wanted).all():
            raise ValueError(f"an action has {self.action_space.shape[0]} finite numbers")
        before = self._state
        self._go(self._act(wanted.clip(-1, 1)))
        self._steps += 1
        reward, terminated = self._judge(before)
        truncated = not terminated and self._steps >= self._steps_most
        self._over = terminated or truncated
        return self._observe(), float(reward), terminated, truncated, self._info()

    def render(self) -> Picture | None:
        """A picture, (height, width, 3); None without a render mode."""
        return None if self.render_mode is None else self._draw()

    # ---- for the tasks
    def _draw_tissue(self) -> int:
        """A seed of a scene's tissue, 1 to `tissue_count`."""
        return 1 + int(self._random.integers(0, _TISSUES)) % self._tissue_count

    def _go(self, commands: Sequence[ToolCommand], ticks: int | None = None) -> None:
        """The tools do this, and time goes on: by a step's ticks, or by so many."""
        self._state: Seen = self._tissue.step(commands, self.ticks if ticks is None else ticks)

    def _faces_of(self, layer: int) -> npt.NDArray[np.int64]:
        """Which faces are those of the scene's layer of this number."""
        return np.flatnonzero(self._tissue.face_layers == layer)

    def _most_exposed(self, part: npt.NDArray[np.int64]) -> float:
        """The largest exposure at those of these faces that still hold; 1 if none does."""
        held = self._tissue.faces[part][~self._state.removed[part]]
        return float(self._state.scalars["exposure"][held].max(initial=0)) if len(held) else 1.0

    # ---- what makes a task
    @abc.abstractmethod
    def _spaces(self) -> tuple[Box, Box]:
        """Of actions and of observations."""

    @abc.abstractmethod
    def _begin(self, options: Mapping[str, Any]) -> None:
        """Draws what is drawn for an episode, begins its scene, and sets `_state` by `_go`."""

    @abc.abstractmethod
    def _act(self, action: npt.NDArray[np.float64]) -> list[ToolCommand]:
        """What the tools do in a step. The action is within -1 and 1."""

    @abc.abstractmethod
    def _observe(self) -> Observation:
        """An array of the space of observations, new each time."""

    @abc.abstractmethod
    def _judge(self, before: Seen) -> tuple[float, bool]:
        """The reward of the step from `before` to `_state`, and whether the episode has ended."""

    @abc.abstractmethod
    def _info(self) -> dict[str, Any]:
        """Further facts, for people and tests."""

    @abc.abstractmethod
    def _draw(self) -> Picture:
        """A picture."""


def is_divided(faces: npt.NDArray[np.int32], ends: tuple[set[int], set[int]]) -> bool:
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
