#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the conformance suite on a server: server.py URL

The server has the scene `fascia`, and everyone is its admin. The output is TAP; the exit code is 1 where a check fails."""

import argparse
import hashlib
import json
import os
import sys

import frames
import wire
from client import channels, expect, report, same_state
from wire import AT_REST

CHANNELS = ["positions", "mask", "exposure", "charring", "stress", "temperature", "tools", "statistics"]
JOIN = {"rate_hz": 1000, "channels": CHANNELS, "plain": True}
CODED_SECTIONS = {1, 2, 3, 4, 5, 9, 16, 17, 18, 19}  # those of elements

# Golden messages: the text that is sent after hello, and code and path of the answer (protocol/README.md, JSON-RPC rules).
REFUSED = [
    ('{"jsonrpc":"2.0","id":7,"method":"session.list"', -32700, None),
    ('{"jsonrpc":"2.0","id":7,"id":8,"method":"session.list"}', -32700, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.list","params":{"a":01}}', -32700, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.list","params":{"a":1e999}}', -32700, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.list","params":{"a":"\\u0000"}}', -32700, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.list","params":{"a":"\\ud800"}}', -32700, None),
    ("[" * 65 + "]" * 65, -32700, None),
    ('[{"jsonrpc":"2.0","id":7,"method":"session.list"}]', -32600, None),
    ('{"jsonrpc":"1.0","id":7,"method":"session.list"}', -32600, None),
    ('{"jsonrpc":"2.0","id":7.5,"method":"session.list"}', -32600, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.list","more":1}', -32600, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.list","params":[]}', -32602, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.fly"}', -32601, None),
    ('{"jsonrpc":"2.0","id":7,"method":"session.list","params":{"what":1}}', -32602, "params.what"),
    ('{"jsonrpc":"2.0","id":7,"method":"session.step","params":{"session":"d1-x","ticks":"1"}}', -32602, "params.ticks"),
    ('{"jsonrpc":"2.0","id":7,"method":"session.step","params":{"session":"No","ticks":1}}', -32602, "params.session"),
    ('{"jsonrpc":"2.0","id":7,"method":"session.describe","params":{"session":"d1-nothing-here"}}', -32040, "params.session"),
]


class Server:
    def __init__(self, url):
        self.url, self.channels = url, channels()
        self.own = self.connect()
        self.session = self.own.small_session(f"conformance-server-{os.getpid()}")
        self.on = {"session": self.session, "tool": "hook"}
        self.own.call("tool.take_over", self.on)

    def connect(self, hello=True):
        return wire.Connection(self.url, self.channels, hello)

    def advance(self, x, ticks, energized):
        move = {"method": "tool.move", "tool": "hook", "position_m": [x, 0, 0.001], "rotation": AT_REST}
        energy = {"method": "tool.energize", "tool": "hook", "energized": energized}
        return self.own.call("session.advance", {"session": self.session, "ticks": ticks, "commands": [move, energy]})["tick"]

    def cut(self):
        self.advance(-0.02, 30, False)
        for i in range(20):
            self.advance(-0.02 + 0.002 * i, 3, True)
        tick = self.advance(0.02, 10, False)
        return self.own.state_at(tick)

    def close(self):
        self.own.call("session.destroy", {"session": self.session})
        self.own.close()


def hello_first(server):
    """Nothing is served before hello."""
    other = server.connect(hello=False)
    other.send({"jsonrpc": "2.0", "id": 1, "method": "session.list"})
    expect(other.answer(1)["error"]["data"]["status"] == "hello_required", "session.list before hello")
    answer = other.call("hello", {"version": 99, "client": "newer"})
    expect(answer["version"] == 1, "a newer client is answered with another version than 1")
    other.close()


def golden_messages(server):
    """Each golden message is refused with its code, at its path."""
    other = server.connect()
    for text, code, path in REFUSED:
        other.send(text)
        number = None if code == -32700 or text.startswith("[") or "7.5" in text else 7
        other.until(lambda number=number: number in other.answers)
        error = other.answers.pop(number)["error"]
        expect(error["code"] == code, f"{text[:80]}: {error}")
        expect(path is None or error["data"]["path"] == path, f"{text[:80]}: {error}")
        expect(error["data"]["status"] and error["data"]["reason"], f"{text[:80]}: no status or reason")
    other.close()


def ids_and_notifications(server):
    """An id comes back as it is; a notification is never answered, whatever it holds."""
    other = server.connect()
    other.send({"jsonrpc": "2.0", "method": "no.such", "params": {"a": 1}})
    other.send({"jsonrpc": "2.0", "method": "session.list"})
    for number in ("text", -5, 2**53 - 1):
        other.send({"jsonrpc": "2.0", "id": number, "method": "session.list", "params": {}})
        expect("sessions" in other.answer(number)["result"], f"id {number!r}")
    expect(not other.answers, f"an answer to nothing: {other.answers}")
    other.close()


def a_chain_of_frames(server):
    """Topology, a key frame, then deltas that build on one another; every frame is whole, and plain as it was asked for."""
    own = server.own
    own.frames.clear()
    own.join({"session": server.session, **JOIN})
    state = server.cut()
    expect(state["removed"], "the cut parts nothing")
    kinds, held, coded = [], None, set()
    for frame in own.frames:
        head, sections = frames.split(frame)
        kinds.append(head["kind"])
        coded |= {payload[2] for kind, payload in sections if kind in CODED_SECTIONS}
        if head["kind"] == frames.KEY:
            expect(head["base"] == head["sequence"], "a key frame with another base")
        elif head["kind"] == frames.DELTA:
            expect((head["epoch"], head["base"]) == held, "a delta that does not build on the frame before")
        if head["kind"] != frames.TOPOLOGY:
            held = (head["epoch"], head["sequence"])
    expect(kinds[:2] == [frames.TOPOLOGY, frames.KEY], f"it begins with {kinds[:2]}")
    expect(set(kinds[2:]) <= {frames.DELTA, frames.KEY} and kinds.count(frames.DELTA) > 5, f"then come {kinds[2:20]}")
    expect(coded == {0}, f"codings {coded}")


def a_key_frame_is_the_chain(server):
    """The key frame that is asked for makes the state that the deltas made, of hidden vertices too."""
    own, step_m = server.own, server.own.decoder.description["step_m"]
    chain = own.decoder.state()
    own.decoder.place = None  # else one of the same sequence is skipped
    own.call("stream.key_frame", {"session": server.session})
    own.until(lambda: own.decoder.place is not None)
    same_state(own.decoder.state(), chain, step_m)


def a_late_joiner(server):
    """A client that joins late has the same state as one that was there before."""
    late = server.connect()
    late.join({"session": server.session, **JOIN})
    same_state(late.state_at(server.own.decoder.tick), server.own.decoder.state(), late.decoder.description["step_m"])
    late.close()


def observations(server):
    """session.advance observes what frames show, to half a step; and the tick is that of the frame."""
    seen = server.own.call("session.advance", {
        "session": server.session, "ticks": 0, "observe": {"channels": ["positions", "mask"]}})
    decoder = server.own.decoder
    expect(seen["tick"] == decoder.tick, f"tick {seen['tick']} and {decoder.tick}")
    expect(seen["mask"] == decoder.held[frames.MASK], "the mask")
    shown, half = decoder.state()["positions_m"], 0.501 * decoder.description["step_m"]
    for v in decoder.drawn_vertices():
        for at in range(3 * v, 3 * v + 3):
            expect(abs(seen["positions_m"][at] - shown[at]) <= half, f"vertex {v}: {seen['positions_m'][at]} and {shown[at]}")


def files(server):
    """A file comes in whole chunks and has the announced hash."""
    announced, data = server.own.file("session.log", {"session": server.session})
    expect(len(data) == announced["byte_count"], f"{len(data)} bytes of {announced['byte_count']}")
    expect(hashlib.sha256(data).hexdigest() == announced["sha256"], "another hash")
    expect(all(json.loads(line)["command"] for line in data.decode().splitlines()), "a line that is no command")


def acting_once(server):
    """A request that is sent again gets its first answer and does nothing."""
    step = {"session": server.session, "ticks": 2, "client_sequence": 1}
    first, again = server.own.call("session.step", step), server.own.call("session.step", step)
    expect(first == again, f"{first} and {again}")


def another_epoch(server):
    """A rewind begins another epoch with a key frame, and no frame of the old one comes after it."""
    own = server.own
    old = own.decoder.place[0]
    own.frames.clear()
    own.call("session.rewind", {"session": server.session, "tick": 0})
    own.state_of_another_epoch(old)
    own.call("session.step", {"session": server.session, "ticks": 3})
    own.state_at(3)
    heads = [frames.split(frame)[0] for frame in own.frames]
    turn = next(i for i, head in enumerate(heads) if head["epoch"] != old)
    expect(heads[turn]["kind"] in (frames.KEY, frames.TOPOLOGY), "the new epoch begins with a delta")
    expect(all(head["epoch"] != old for head in heads[turn:]), "a frame of the old epoch after the new one")
    expect(not own.decoder.state()["removed"], "faces are removed at the beginning")


CHECKS = [hello_first, golden_messages, ids_and_notifications, a_chain_of_frames, a_key_frame_is_the_chain, a_late_joiner,
          observations, files, acting_once, another_epoch]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("url", help="ws://HOST:PORT")
    options = parser.parse_args()
    server = Server(options.url)
    failures = report(CHECKS, server)
    server.close()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
