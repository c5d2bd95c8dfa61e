# SPDX-License-Identifier: GPL-3.0-or-later
"""The suite's own connection to a daemon, and the session that it makes there. Every frame is decoded as plain."""

import json
import time

from cautery.websocket import WebSocket

import frames

PATIENCE_S = 60
AT_REST = [1, 0, 0, 0]
CELLS = [24, 20]  # of the scene, so that it is quick to step


class Refused(Exception):
    """A request that the daemon refused; `error` is the answer's."""

    def __init__(self, error):
        super().__init__(json.dumps(error))
        self.error = error


class Connection:
    """Reads only while it waits for something."""

    def __init__(self, url, channels, hello=True):
        self.socket = WebSocket(url, "cautery.v1", PATIENCE_S)
        self.channels, self.ids, self.answers, self.decoder = channels, 0, {}, None
        self.chunks, self.frames = {}, []
        if hello:
            self.server = self.call("hello", {"version": 1, "client": "conformance"})

    def small_session(self, name):
        """A paused sheet with a hook, which parts at once where it is hot."""
        definition = self.call("scene.get", {"scene": "fascia"})["definition"]
        definition["meshes"][0]["cells"][:2] = CELLS
        definition["layers"][0].update(ignition_c=80, absorption_per_s=20)
        definition["name"] = "small"
        definition.pop("cut", None)
        made = self.call("session.create", {"name": name, "definition": definition, "paused": True})
        return made["summary"]["session"]

    def send(self, message):
        self.socket.send_text(message if isinstance(message, str) else json.dumps(message))

    def call(self, method, params):
        self.ids += 1
        self.send({"jsonrpc": "2.0", "id": self.ids, "method": method, "params": params})
        answer = self.answer(self.ids)
        if "error" in answer:
            raise Refused(answer["error"])
        return answer["result"]

    def answer(self, number):
        self.until(lambda: number in self.answers)
        return self.answers.pop(number)

    def until(self, condition):
        end_s = time.monotonic() + PATIENCE_S
        while not condition():
            if time.monotonic() > end_s:
                raise TimeoutError("it did not come")
            self.take(self.socket.receive())

    def take(self, message):
        if isinstance(message, str):
            read = json.loads(message)
            if "id" in read:
                self.answers[read["id"]] = read
                self._begin_stream(read.get("result"))
        elif message[:4] == b"CAUC":
            self.chunks.setdefault(int.from_bytes(message[4:8], "little"), bytearray()).extend(message[16:])
        else:
            self.frames.append(message)
            self.decoder.take(message)

    def _begin_stream(self, result):
        if isinstance(result, dict) and "session_number" in result and "rate_hz" in result:
            self.decoder = frames.Decoder(result, self.channels)

    def join(self, params):
        self.call("session.join", params)
        self.until(lambda: self.decoder.place is not None)

    def state_at(self, tick):
        self.until(lambda: self.decoder.place is not None and self.decoder.tick >= tick)
        return self.decoder.state()

    def state_of_another_epoch(self, epoch):
        self.until(lambda: self.decoder.place is not None and self.decoder.place[0] != epoch)
        return self.decoder.state()

    def file(self, method, params):
        announced = self.call(method, params)
        number, count = announced["transfer"], announced["byte_count"]
        self.until(lambda: len(self.chunks.get(number, b"")) >= count)
        return announced, bytes(self.chunks.pop(number, b""))

    def close(self):
        self.socket.close()
        self.socket.abandon()
