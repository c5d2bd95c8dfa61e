#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The adapter of the suite's own decoder and connection: reference_client.py [FAULT]. It lacks meshoptimizer.

With a fault it makes one mistake, which the suite must find (faults_test.py)."""

import hashlib
import sys

import client
import frames
import wire
from adapter import serve

FAULT = sys.argv[1] if len(sys.argv) > 1 else None


class Reference:
    def __init__(self):
        self.decoder = self.connection = self.first = None

    def decode(self, description):
        self.decoder = frames.Decoder(description, client.channels(), FAULT)
        return {}

    def frame(self, bytes):
        try:
            return {"took": "yes" if self.decoder.take(bytes) else "no"}
        except frames.Bad:
            return {"took": "no" if FAULT == "swallows_bad" else "bad"}

    def state(self):
        decoder = self.connection.decoder if self.connection and self.connection.decoder else self.decoder
        return decoder.state()

    def connect(self, url):
        self.connection = wire.Connection(url, client.channels())
        return {}

    def call(self, method, params):
        try:
            return {"result": self.connection.call(method, params)}
        except wire.Refused as refused:
            error = refused.error
            if FAULT == "swallows_errors":
                return {"result": None}
            return {"error": {"code": error["code"], "path": error.get("data", {}).get("path")}}

    def together(self, calls):
        first = self.connection.ids + 1
        for one in calls:
            self.connection.ids += 1
            self.connection.send({"jsonrpc": "2.0", "id": self.connection.ids, **one})
        answers = [self.connection.answer(first + i) for i in range(len(calls))]
        if FAULT == "mixes_answers":
            answers.reverse()
        return {"answers": answers}

    def join(self, params):
        self.connection.join({**params, "plain": True})
        if FAULT == "mask_order":
            self.connection.decoder.fault = FAULT
        return {"description": self.connection.decoder.description}

    def settle(self, tick):
        state = self.connection.state_at(tick)
        self.first = self.first or state
        return self.first if FAULT == "stays_behind" else state

    def file(self, method, params):
        _, data = self.connection.file(method, params)
        if FAULT == "cuts_files":
            data = data[:-1]
        return {"sha256": hashlib.sha256(data).hexdigest()}


if __name__ == "__main__":
    reference = Reference()
    names = ("decode", "frame", "state", "connect", "call", "together", "join", "settle", "file")
    serve({name: getattr(reference, name) for name in names}, ["meshopt"])
