# SPDX-License-Identifier: Apache-2.0
"""Simulates the tissue of a task: in a daemon, or in this process with the core."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, Mapping, Protocol, Sequence

import numpy as np
import numpy.typing as npt

from ..client import Client
from ..errors import Error, RequestError
from ..local import LocalDaemon
from ..messages import AdvanceCommand, ObservedTool, ObservedVessel
from ..session import Session

Floats = npt.NDArray[np.float64]

_REST = (1.0, 0.0, 0.0, 0.0)
_CHANNELS: list[Any] = ["positions", "mask", "tools", "vessels"]
# Settings of a daemon that a task starts. It has only one client, so it needs no quotas.
_OWN = {"quota_connection": 1000000, "quota_address": 1000000, "quota_operate": 1000000, "quota_admin": 1000000,
        "quota_all": 1000000}


@dataclass(frozen=True)
class ToolCommand:
    """Command of a tool for a step. `rotation` is w, x, y, z. `jaw`: 0 closed to 1 open. `grasping`: the jaws hold."""

    tool: str
    position_m: Floats  # (3,), of the tip
    rotation: tuple[float, float, float, float] = _REST
    jaw: float = 0.0
    energized: bool = False
    grasping: bool = False


@dataclass(frozen=True)
class SeenTool:
    """A tool after a step. `power_w` and `load_ohm` are 0 in scenes with energy `paper`."""

    position_m: Floats  # (3,), of the tip: tissue can stop the tool
    jaw: float  # 0 closed to 1 open
    energized: bool
    grasped_vertices: int  # number of points that the jaws hold
    force_n: Floats  # (3,), of the tissue on the tool, filtered
    tip_temperature_c: float
    power_w: float  # power given to tissue in the last tick
    load_ohm: float  # load of the generator; 0: no current flows


@dataclass(frozen=True)
class SeenVessel:
    """A blood vessel after a step."""

    parted: bool
    pierced: bool  # the wall has a hole
    shut: bool  # pressed so flat somewhere that no blood flows
    sealed: bool  # a seal withstands the blood pressure
    bleeds: bool
    bleeding_m3_s: float  # flow of blood out of the vessel in the last tick
    shed_m3: float  # volume of blood that has left the vessel since the beginning
    burst_pa: float  # predicted pressure at which the best seal opens; 0: no seal


@dataclass(frozen=True)
class Seen:
    """The tissue after a step. V vertices, F faces. Tools and vessels by name."""

    tick: int
    positions: Floats  # (V, 3), m
    removed: npt.NDArray[np.bool_]  # (F,)
    scalars: Mapping[str, Floats]  # (V,) each, by channel; only channels that the task requested
    tools: Mapping[str, SeenTool]
    vessels: Mapping[str, SeenVessel]


class Tissue(Protocol):
    """A session of a scene. A task calls `begin` first, and again for each episode."""

    faces: npt.NDArray[np.int32]  # (F, 3)
    face_layers: npt.NDArray[np.int32]  # (F,)
    rest: Floats  # (V, 3), m

    def begin(self, scene: Mapping[str, Any], scalars: Sequence[str]) -> None:
        """Begins at tick 0 of a scene, energy off and nothing grasped. `scalars` are the channels that steps return."""

    def step(self, commands: Sequence[ToolCommand], ticks: int) -> Seen:
        """Commands tools and advances by `ticks` ticks. A tool without a command continues its last command."""

    def close(self) -> None:
        """Ends the session."""


def _seen_tool(tool: ObservedTool) -> SeenTool:
    return SeenTool(np.asarray(tool["position_m"], float), tool["jaw"], tool["energized"], tool["grasped_vertices"],
                    np.asarray(tool["force_n"], float), tool["tip_temperature_c"], tool["power_w"], tool["load_ohm"])


def _seen_vessel(vessel: ObservedVessel) -> SeenVessel:
    return SeenVessel(vessel["parted"], vessel["pierced"], vessel["shut"], vessel["sealed"], vessel["bleeds"],
                      vessel["bleeding_m3_s"], vessel["shed_m3"], vessel["burst_pa"])


class RemoteTissue:
    """A session of a daemon. By default it starts a daemon, with `settings` as further settings."""

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

    def begin(self, scene: Mapping[str, Any], scalars: Sequence[str]) -> None:
        """Creates a new session, which replaces the last one."""
        if self._session:
            self._client.session_destroy(session=self._session.name)
        made = self._client.session_create(definition=scene, paused=True, ephemeral=True)  # type: ignore[arg-type]
        self._session = Session(self._client, made["summary"])
        stream = self._client.join(self._session.name)  # for the faces, which stay as they are
        self._client.session_leave(session=self._session.name)
        self._done: dict[str, ToolCommand] = {}
        self._channels = [*_CHANNELS, *scalars]
        for tool in scene["tools"]:
            self._client.tool_take_over(session=self._session.name, tool=tool["name"])
        self.faces, self.face_layers, self.rest = stream.faces, stream.face_layers, stream.rest

    def _commands(self, wanted: ToolCommand) -> list[AdvanceCommand]:
        done = self._done.get(wanted.tool)
        commands: list[AdvanceCommand] = [{
            "method": "tool.move", "tool": wanted.tool, "position_m": wanted.position_m.tolist(),
            "rotation": wanted.rotation, "jaw": wanted.jaw}]
        if wanted.energized != (done is not None and done.energized):
            commands.append({"method": "tool.energize", "tool": wanted.tool, "energized": wanted.energized})
        if wanted.grasping != (done is not None and done.grasping):
            commands.append({"method": "tool.grasp" if wanted.grasping else "tool.release", "tool": wanted.tool})
        return commands

    def step(self, commands: Sequence[ToolCommand], ticks: int) -> Seen:
        """Advances the session in lock-step, and observes it."""
        assert self._session
        try:
            state = self._session.advance(ticks, [one for wanted in commands for one in self._commands(wanted)],
                                          {"channels": self._channels})
        except RequestError as error:
            if error.status == "faulted":
                raise Error("the motion of the tissue became numerically unsound: call reset") from error
            raise
        self._done.update({wanted.tool: wanted for wanted in commands})
        for name, done in self._done.items():
            if state.tools[name]["energized"] != done.energized:
                raise Error(f"tool {name!r}: energy went on or off without a command of this environment "
                            f"(energy_off: {state.tools[name].get('energy_off')}): is another client in this session?")
        assert state.positions is not None and state.removed is not None
        return Seen(state.tick, state.positions, state.removed, state.scalars,
                    {name: _seen_tool(tool) for name, tool in state.tools.items()},
                    {name: _seen_vessel(vessel) for name, vessel in state.vessels.items()})

    def close(self) -> None:
        """Ends the session, and the daemon if it is the task's own."""
        self._things.close()
