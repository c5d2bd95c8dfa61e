# SPDX-License-Identifier: GPL-3.0-or-later
"""The tasks of `cautery.environments` in this process: the same scenes, observations, rewards and seeds.

    from cautery_core.environments import PartBand

    environment = PartBand()
    observation, info = environment.reset(seed=1)
"""

from __future__ import annotations

import json
from collections import OrderedDict
from typing import Any, Mapping, Sequence

from cautery.environments import clear_plane, part_band, seal_and_divide
from cautery.environments.tissue import Seen, SeenTool, SeenVessel, ToolCommand

from .session import Session, Tool, Vessel


def _seen_tool(tool: Tool) -> SeenTool:
    return SeenTool(tool.position_m, tool.jaw, tool.energized, tool.grasped_vertices, tool.force_n,
                    tool.tip_temperature_c, tool.power_w, tool.load_ohm)


def _seen_vessel(vessel: Vessel) -> SeenVessel:
    return SeenVessel(vessel.parted, vessel.pierced, vessel.shut, vessel.sealed, vessel.bleeds, vessel.bleeding_m3_s,
                      vessel.shed_m3, vessel.burst_pa)


class CoreTissue:
    """A session in this process. The sessions of the last `kept` scenes are kept, each with a snapshot of its beginning.

    Beginning again with a kept scene restores the snapshot, which is faster than building a session.
    """

    def __init__(self, kept: int = 4, *, instruction_set: str | None = None) -> None:
        if kept < 1:
            raise ValueError("kept must be at least 1")
        self._kept, self._instruction_set = kept, instruction_set
        self._sessions: OrderedDict[str, tuple[Session, bytes]] = OrderedDict()
        self._session: Session | None = None
        self._done: dict[str, ToolCommand] = {}
        self._scalars: Sequence[str] = ()

    @property
    def session(self) -> Session:
        """The session of the present episode."""
        if self._session is None:
            raise ValueError("there is no session: call begin first")
        return self._session

    def begin(self, scene: Mapping[str, Any], scalars: Sequence[str]) -> None:
        """Builds the scene, or restores the snapshot of its beginning."""
        text = json.dumps(scene, sort_keys=True)
        if text in self._sessions:
            session, beginning = self._sessions[text]
            session.restore(beginning)
        else:
            session = Session(scene, instruction_set=self._instruction_set)
            self._sessions[text] = session, session.snapshot()
        self._sessions.move_to_end(text)
        while len(self._sessions) > self._kept:
            self._sessions.popitem(last=False)[1][0].close()
        self._session, self._done, self._scalars = session, {}, scalars
        self.faces, self.face_layers, self.rest = session.faces, session.face_layers, session.rest

    def step(self, commands: Sequence[ToolCommand], ticks: int) -> Seen:
        """Computes `ticks` steps. The commands take effect at the first tick."""
        now = self.session
        for wanted in commands:
            self._command(now, wanted)
        tick = now.step(ticks)
        return Seen(tick, now.positions, now.removed, {name: now.scalar(name).astype(float) for name in self._scalars},
                    {name: _seen_tool(tool) for name, tool in now.tools.items()},
                    {name: _seen_vessel(vessel) for name, vessel in now.vessels.items()})

    def _command(self, session: Session, wanted: ToolCommand) -> None:
        done = self._done.get(wanted.tool)
        session.move_tool(wanted.tool, wanted.position_m, wanted.rotation, wanted.jaw)
        if wanted.energized != (done is not None and done.energized):
            session.energize(wanted.tool, wanted.energized)
        if wanted.grasping != (done is not None and done.grasping):
            (session.grasp if wanted.grasping else session.release)(wanted.tool)
        self._done[wanted.tool] = wanted

    def close(self) -> None:
        """Ends all sessions."""
        for session, _ in self._sessions.values():
            session.close()
        self._sessions.clear()
        self._session = None


class _InProcess:
    """A task without a daemon. If `tissue_count` is at most `kept`, each reset restores a snapshot of a tissue."""

    def __init__(self, *, render_mode: str | None = None, tissue_count: int | None = None, kept: int = 4,
                 instruction_set: str | None = None, **how: Any) -> None:
        if tissue_count is not None:
            how["tissue_count"] = tissue_count
        super().__init__(render_mode=render_mode, tissue=CoreTissue(kept, instruction_set=instruction_set), **how)


class PartBand(_InProcess, part_band.PartBand):
    """`cautery.environments.PartBand` without a daemon, and with equal episodes."""


class ClearPlane(_InProcess, clear_plane.ClearPlane):
    """`cautery.environments.ClearPlane` without a daemon, and with equal episodes."""


class SealAndDivide(_InProcess, seal_and_divide.SealAndDivide):
    """`cautery.environments.SealAndDivide` without a daemon, and with equal episodes."""
