# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop of an adapter: a line of JSON in, a line of JSON out (README.md)."""

import base64
import json
import sys


def serve(commands, lacks=()):
    """`commands`: for each `do` a function of the other members, which returns the answer."""
    print(json.dumps({"lacks": list(lacks)}), flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        do = asked.pop("do")
        if "bytes" in asked:
            asked["bytes"] = base64.b64decode(asked["bytes"])
        try:
            answer = commands[do](**asked)
        except Exception as error:  # noqa: BLE001: the suite is told whatever it is
            answer = {"failed": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)
