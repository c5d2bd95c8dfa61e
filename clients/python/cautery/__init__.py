# SPDX-License-Identifier: Apache-2.0
"""Client of cauteryd, the simulation server for energized soft-tissue dissection.

    import cautery

    with cautery.Client("ws://127.0.0.1:8740") as client:
        print(client.scene_list())

Streams are numpy arrays. README.md has a first cut; `messages` has every message of the wire.
"""

from .client import Client
from .errors import (BadFrame, ConnectionClosed, ConnectionRefused, Error, NoAnswer,
                     RequestError)
from .session import Advanced, Session
from .stream import State, Stream, Tool

__all__ = ["Advanced", "BadFrame", "Client", "ConnectionClosed", "ConnectionRefused", "Error", "NoAnswer",
           "RequestError", "Session", "State", "Stream", "Tool"]
__version__ = "0.1.0.dev0"
