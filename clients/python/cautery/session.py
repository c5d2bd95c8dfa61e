# SPDX-License-Identifier: Apache-2.0
"""A session in lock-step: it computes ticks when this program asks, and returns what was observed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from .client import Client
from .errors import Error
from .messages import AdvanceCommand, Observe, ObservedEnergy, ObservedTool, ObservedVessel, RegionDamage


@dataclass(frozen=True)
class Advanced:
    """What `Session.advance` has observed. A member that was not requested is None or empty.

    `positions` (vertices x 3, metres), `removed` (faces; True: not drawn), `scalars` by channel, `tools`, `vessels`
    and `regions` by name. `energy` is where the energy of the instruments went, J. `stored` is whether the ticks are on
    the disk.
    """

    tick: int
    time_s: float
    stored: bool
    positions: npt.NDArray[np.float64] | None
    removed: npt.NDArray[np.bool_] | None
    scalars: Mapping[str, npt.NDArray[np.float64]]
    tools: Mapping[str, ObservedTool]
    regions: Mapping[str, RegionDamage]
    energy: ObservedEnergy | None = None
    vessels: Mapping[str, ObservedVessel] = field(default_factory=dict)


def _bits(words: Sequence[int], count: int) -> npt.NDArray[np.bool_]:
    return np.unpackbits(np.asarray(words, "<u4").view(np.uint8), bitorder="little")[:count].astype(bool)


class Session:
    """A paused session that this client advances: `Session(client, made["summary"])`.

    Meanwhile the daemon counts the silence of the driver in ticks, not in seconds. So no heartbeats are needed, and
    energy stays on while the program computes. A lost connection still turns energy off.
    """

    def __init__(self, client: Client, summary: Mapping[str, object]) -> None:
        self.client = client
        self.name = str(summary["session"])
        self._face_count = int(str(summary["face_count"]))

    def advance(self, ticks: int = 1, commands: Sequence[AdvanceCommand] = (), observe: Observe | None = None) -> Advanced:
        """Applies all commands, then computes the ticks.

        If a command is refused, none is applied: raises RequestError.

        Raises Error if fewer ticks were computed because another client ended lock-step. Then energy is off.
        """
        result = self.client.session_advance(session=self.name, ticks=ticks, commands=list(commands), observe=observe)
        if result["ticks"] < ticks:
            raise Error(f"lock-step was ended after {result['ticks']} of {ticks} ticks, and energy is off")
        positions, mask = result.get("positions_m"), result.get("mask")
        return Advanced(
            tick=result["tick"], time_s=result["time_s"], stored=result["stored"],
            positions=None if positions is None else np.asarray(positions, float).reshape(-1, 3),
            removed=None if mask is None else _bits(mask, self._face_count),
            scalars={one["channel"]: np.asarray(one["values"], float) for one in result.get("scalars", ())},
            tools={one["tool"]: one for one in result.get("tools", ())},
            regions={one["name"]: one for one in result.get("regions", ())},
            energy=result.get("energy"),
            vessels={one["vessel"]: one for one in result.get("vessels", ())})
