# SPDX-License-Identifier: GPL-3.0-or-later
"""Somebody at a session of a fleet, many of them in one asyncio loop: a viewer, who reads frames, or a
driver, who moves the tool by requests and remembers which were acknowledged. Comes back by itself."""

import asyncio
import base64
import itertools
import json
import time

RETRY_S = 0.25
MOVE_EVERY_S = 0.2
ANSWER_S = 60  # far beyond what an answer takes


class Lost(Exception):
    pass


def where_it_went(message, session):
    """The id that this session has now, if a notice (they go to all) or an answer says that it has moved; or None."""
    data = message.get("error", {}).get("data", {})
    if message.get("method") == "session.changed" and message["params"]["summary"]["session"] == session:
        data = message["params"]
    return data.get("moved_to") or None


class Socket:
    """What is needed of RFC 6455."""

    def __init__(self, reader, writer):
        self.reader, self.writer = reader, writer

    @classmethod
    async def open(cls, fleet, path):
        reader, writer = await asyncio.wait_for(
            asyncio.open_connection(fleet.host, fleet.port, ssl=fleet.tls,
                                    server_hostname=fleet.name if fleet.tls else None), ANSWER_S)
        key = base64.b64encode(bytes(16)).decode()
        writer.write((f"GET {path} HTTP/1.1\r\nHost: {fleet.name}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: cautery.v1\r\n"
                      f"Sec-WebSocket-Key: {key}\r\n\r\n").encode())
        head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), ANSWER_S)
        if b" 101 " not in head.split(b"\r\n")[0]:
            writer.close()
            raise Lost(head.decode(errors="replace"))
        return cls(reader, writer)

    def send(self, kind, payload):
        size = len(payload)
        length = bytes([0x80 | size]) if size < 126 else bytes([0x80 | 126]) + size.to_bytes(2, "big")
        self.writer.write(bytes([0x80 | kind]) + length + bytes(4) + payload)  # masked with zeros

    async def receive(self):
        """(kind, payload) of a message; the daemon splits none."""
        head = await self.reader.readexactly(2)
        size = head[1] & 127
        if size >= 126:
            size = int.from_bytes(await self.reader.readexactly(2 if size == 126 else 8), "big")
        payload = await self.reader.readexactly(size)
        kind = head[0] & 15
        if kind == 9:
            self.send(10, payload)
        if kind == 8:
            raise Lost("closed by the server")
        return kind, payload

    def close(self):
        self.writer.transport.abort()


class Person:
    def __init__(self, fleet, session, drives):
        self.fleet, self.session, self.drives = fleet, session, drives
        self.label = session.split("-")[0]
        self.client_id = f"{'driver' if drives else 'viewer'}_{session.replace('-', '_')}"
        self.ids, self.sequences, self.moves = itertools.count(1), itertools.count(1), itertools.count(1)
        self.socket = None
        self.waiting = {}  # id: future
        self.pending = None  # (client_sequence, params) of a move without its answer
        self.acknowledged, self.refused = [], 0  # moves: (sequence, tick that the answer says)
        self.frames = 0
        self.followed = 0  # times that its session had moved
        self.outages = []  # [from, to], to None while it lasts
        self.ready = asyncio.Event()

    async def call(self, method, params):
        number = next(self.ids)
        future = self.waiting[number] = asyncio.get_running_loop().create_future()
        self.socket.send(1, json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}).encode())
        try:
            return await asyncio.wait_for(future, ANSWER_S)
        finally:
            self.waiting.pop(number, None)

    async def read(self):
        try:
            while True:
                kind, payload = await self.socket.receive()
                self.frames += kind == 2
                message = json.loads(payload) if kind == 1 else {}
                moved_to = where_it_went(message, self.session)
                if moved_to:
                    self.follow(moved_to)
                    raise Lost("moved")
                future = self.waiting.get(message.get("id"))
                if future and not future.done():
                    future.set_result(message)
        except (OSError, asyncio.IncompleteReadError, Lost) as error:
            for future in self.waiting.values():
                if not future.done():
                    future.set_exception(Lost(str(error)))

    def follow(self, session):
        """What has no answer yet is asked again of who has the session now."""
        self.session, self.label = session, session.split("-")[0]
        self.followed += 1
        if self.pending:
            self.pending[1]["session"] = session

    async def greet(self):
        answer = await self.call("hello", {"version": 1, "client": "fleet test", "client_id": self.client_id,
                                           "token": self.fleet.token})
        if "error" in answer:
            raise Lost(str(answer["error"]))
        if not self.drives:
            answer = await self.call("session.join", {"session": self.session, "rate_hz": 5})
            if "error" in answer:
                raise Lost(str(answer["error"]))
            return
        if self.pending:  # first what may have been done, or else what comes later makes it old
            await self.move()
        await self.call("tool.take_over", {"session": self.session, "tool": "hook",
                                           "client_sequence": next(self.sequences)})

    async def move(self):
        """The one that has no answer yet, or a new one."""
        if not self.pending:
            number = next(self.moves)
            self.pending = (number, {"session": self.session, "tool": "hook", "sequence": number,
                                     "client_sequence": next(self.sequences), "rotation": [1, 0, 0, 0],
                                     "position_m": [1e-4 * (number % 100), 0, 0.01]})
        answer = await self.call("tool.move", self.pending[1])
        if "error" in answer:
            self.refused += 1
        else:
            self.acknowledged.append((self.pending[0], answer["result"]["tick"]))
        self.pending = None

    async def stay(self, reading):
        while not reading.done():
            if not self.drives:
                await reading
                return
            await self.move()
            await asyncio.sleep(MOVE_EVERY_S)

    async def attend(self):
        """One connection, until it is lost."""
        self.socket = await Socket.open(self.fleet, f"/v1?session={self.session}")
        reading = asyncio.ensure_future(self.read())
        try:
            await self.greet()
            if self.outages:
                self.outages[-1][1] = time.monotonic()
            self.ready.set()
            await self.stay(reading)
        finally:
            reading.cancel()
            self.waiting.clear()
            self.socket.close()

    async def live(self):
        while True:
            try:
                await self.attend()
            except (OSError, asyncio.IncompleteReadError, asyncio.TimeoutError, Lost):
                pass
            if self.ready.is_set():
                self.ready.clear()
                self.outages.append([time.monotonic(), None])
            await asyncio.sleep(RETRY_S)
