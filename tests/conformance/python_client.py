#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The adapter of the Python package `cautery`."""

import hashlib
import threading

import numpy as np

import cautery
from adapter import serve
from cautery.stream import Stream


def state_of(stream):
    place = stream.place()
    held = stream.wait(timeout_s=0)
    return {
        "epoch": place[0], "sequence": place[1], "tick": held.tick,
        "positions_m": held.positions.reshape(-1).tolist(),
        "removed": np.flatnonzero(held.removed).tolist(),
        "tools": [{"name": tool.name, "sequence": tool.sequence, "energized": tool.energized,
                   "position_m": tool.position_m.tolist()} for tool in held.tools.values()],
        **{name: values.tolist() for name, values in held.scalars.items()}}


class Package:
    def __init__(self):
        self.stream = self.client = None

    def decode(self, description):
        self.stream = Stream(description)
        return {}

    def frame(self, bytes):
        try:
            return {"took": "no" if self.stream.take(bytes) == "skipped" else "yes"}
        except cautery.BadFrame:
            return {"took": "bad"}

    def state(self):
        return state_of(self.stream)

    def connect(self, url):
        self.client = cautery.Client(url)
        return {}

    def call(self, method, params):
        try:
            return {"result": self.client.call(method, params)}
        except cautery.RequestError as error:
            return {"error": {"code": error.code, "path": error.path}}

    def together(self, calls):
        answers = [None] * len(calls)

        def ask(i):
            answers[i] = self.call(calls[i]["method"], calls[i]["params"])

        threads = [threading.Thread(target=ask, args=(i,)) for i in range(len(calls))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return {"answers": answers}

    def join(self, params):
        self.stream = self.client.join(**params)
        return {"description": self.stream.description}

    def settle(self, tick):
        self.stream.wait(tick)
        return self.state()

    def file(self, method, params):
        return {"sha256": hashlib.sha256(self.client.download(method, params)).hexdigest()}


if __name__ == "__main__":
    package = Package()
    names = ("decode", "frame", "state", "connect", "call", "together", "join", "settle", "file")
    serve({name: getattr(package, name) for name in names})
