# SPDX-License-Identifier: Apache-2.0
"""Where a task's tissue is simulated: in a daemon, or in a process that contains the core."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, Mapping, Protocol

import numpy as np
import numpy.typing as npt

from ..client import Client
from ..errors import Error, RequestError
from ..local import LocalDaemon
from ..messages import AdvanceCommand
from ..session import Session

_REST = (1.0, 0.0, 0.0, 0.0)
_CHANNELS: list[Any] = ["positions", "mask", "exposure", "tools"]
# Settings of the task's own daemon. It has one client, so its quotas have no use.
_OWN = {"quota_connection": 1000000, "quota_address": 1000000, "quota_operate": 1000000, "quota_admin": 1000000,
        "quota_all": 1000000}


@dataclass(frozen=True)
class Seen:
    """The tissue after a step. V vertices, F faces."""

    tick: int
    positions: npt.NDArray[np.float64]  # (V, 3), m
    removed: npt.NDArray[np.bool_]  # (F,)
    exposure: npt.NDArray[np.float64]  # (V,), 0 to 1


class Tissue(Protocol):
    """A session of one tool, the first of its scene. `begin` comes first, and again for each episode."""

    faces: npt.NDArray[np.int32]  # (F, 3)
    face_layers: npt.NDArray[np.int32]  # (F,)
    rest: npt.NDArray[np.float64]  # (V, 3), m

    def begin(self, scene: Mapping[str, Any]) -> None:
        """Begins at tick 0 of a scene, energy off."""

    def step(self, tip_m: npt.NDArray[np.float64], energized: bool, ticks: int) -> Seen:
        """Commands the tool's place and energy, and goes on by so many ticks."""

    def close(self) -> None:
        """Ends it."""


class RemoteTissue:
    """A session of a daemon, by default of one of its own. `settings`: further ones of that daemon."""

    def __init__(self, url: str | None = None, daemon: str | None = None, **settings: object) -> None:
        self._things = contextlib.ExitStack()
        self._session: Session | None = None
        try:
            if url is None:
                url = self._things.enter_context(LocalDaemon(daemon, **{**_OWN, **settings})).url
            self._client = self._things.enter_context(Client(url, name="cautery task"))
        except BaseException:
            self._things.close()
            raise

    def begin(self, scene: Mapping[str, Any]) -> None:
        """Makes another session in the place of the last one."""
        if self._session:
            self._client.session_destroy(session=self._session.name)
        made = self._client.session_create(definition=scene, paused=True, ephemeral=True)  # type: ignore[arg-type]
        self._session, self._tool = Session(self._client, made["summary"]), scene["tools"][0]["name"]
        stream = self._client.join(self._session.name)  # for the faces, which stay as they are
        self._client.session_leave(session=self._session.name)
        self._client.tool_take_over(session=self._session.name, tool=self._tool)
        self._energized = False
        self.faces, self.face_layers, self.rest = stream.faces, stream.face_layers, stream.rest

    def step(self, tip_m: npt.NDArray[np.float64], energized: bool, ticks: int) -> Seen:
        """Advances the session in lock-step, and observes it."""
        assert self._session
        commands: list[AdvanceCommand] = [
            {"method": "tool.move", "tool": self._tool, "position_m": tip_m.tolist(), "rotation": _REST}]
        if energized != self._energized:
            commands.append({"method": "tool.energize", "tool": self._tool, "energized": energized})
        try:
            state = self._session.advance(ticks, commands, {"channels": _CHANNELS})
        except RequestError as error:
            if error.status == "faulted":
                raise Error("the tissue's motion became numerically unsound: reset") from error
            raise
        self._energized = energized
        if state.tools[self._tool]["energized"] != energized:
            raise Error("energy went off by itself: somebody else uses this session")
        assert state.positions is not None and state.removed is not None
        return Seen(state.tick, state.positions, state.removed, state.scalars["exposure"])

    def close(self) -> None:
        """Ends the session, and the daemon if it is the task's own."""
        self._things.close()
