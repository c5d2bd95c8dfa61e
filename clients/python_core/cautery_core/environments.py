# SPDX-License-Identifier: GPL-3.0-or-later
"""The tasks of `cautery.environments` in this process: the same scenes, observations, rewards and seeds.

    from cautery_core.environments import PartBand

    environment = PartBand()
    observation, info = environment.reset(seed=1)
"""

from __future__ import annotations

import json
from collections import OrderedDict
from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from cautery.environments import part_band
from cautery.environments.tissue import Seen

from .session import Session



class CoreTissue:
    """A session in this process. `kept`: of so many scenes, the last ones, a session and its beginning are kept.

    To begin again with such a scene is to restore a snapshot, which is faster than to build the session.
    """

    def __init__(self, kept: int = 4, *, instruction_set: str | None = None) -> None:
        if kept < 1:
            raise ValueError("one scene is kept at least")
        self._kept, self._instruction_set = kept, instruction_set
        self._sessions: OrderedDict[str, tuple[Session, bytes]] = OrderedDict()
        self._session: Session | None = None
        self._energized = False

    def begin(self, scene: Mapping[str, Any]) -> None:
        """Builds the scene, or restores its beginning."""
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
        self._session, self._tool, self._energized = session, scene["tools"][0]["name"], False
        self.faces, self.face_layers, self.rest = session.faces, session.face_layers, session.rest

    def step(self, tip_m: npt.NDArray[np.float64], energized: bool, ticks: int) -> Seen:
        """The command acts at the first of the ticks."""
        if self._session is None:
            raise ValueError("there is no session: call begin")
        self._session.move_tool(self._tool, tip_m)
        if energized != self._energized:
            self._session.energize(self._tool, energized)
            self._energized = energized
        tick = self._session.step(ticks)
        return Seen(tick, self._session.positions, self._session.removed, self._session.scalar("exposure").astype(float))

    def close(self) -> None:
        """Ends all sessions."""
        for session, _ in self._sessions.values():
            session.close()
        self._sessions.clear()
        self._session = None


class PartBand(part_band.PartBand):
    """`cautery.environments.PartBand` without a daemon, and with equal episodes.

    With `tissue_count`, at most `kept` of whose tissues are kept, a reset restores a snapshot.
    """

    def __init__(self, *, render_mode: str | None = None, tissue_count: int | None = None, kept: int = 4,
                 instruction_set: str | None = None, **how: Any) -> None:
        if tissue_count is not None:
            how["tissue_count"] = tissue_count
        super().__init__(render_mode=render_mode, tissue=CoreTissue(kept, instruction_set=instruction_set), **how)
