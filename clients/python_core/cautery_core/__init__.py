# SPDX-License-Identifier: GPL-3.0-or-later
"""The simulation of energized soft-tissue dissection, in this process.

    import cautery_core

    with cautery_core.Session("fascia.json") as session:
        session.step(60)
        print(session.positions.max(axis=0))

README.md has a first cut; `cautery_core.environments` has tasks for learners. This package is under the GPL, as what it
loads is. A program that must not be under the GPL talks to a daemon with the package `cautery`.
"""

from .errors import CommandRefused, CoreError
from .session import Layer, Session, Tool, Vessel

__all__ = ["CommandRefused", "CoreError", "Layer", "Session", "Tool", "Vessel"]
__version__ = "0.1.0.dev0"
