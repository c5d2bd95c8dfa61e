#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the conformance suite on a client: client.py --golden FOLDER [--url URL] -- ADAPTER [ARGUMENT...]

README.md says what an adapter is. The output is TAP; the exit code is 1 where a check fails."""

import argparse
import base64
import functools
import hashlib
import json
import math
import os
import struct
import subprocess
import sys
import time

import frames
from frames import Bad
from wire import AT_REST, Connection, Refused

HERE = os.path.dirname(os.path.abspath(__file__))
ASYNCAPI = os.path.join(HERE, "..", "..", "protocol", "asyncapi.json")
ANSWER_S = 60  # far beyond what any answer needs
NO_SESSION, BAD_VALUE, NO_METHOD = -32040, -32602, -32601  # codes of the protocol
UNKNOWN_SECTION = 60  # a type that the protocol does not have


class Failed(Exception):
    """A check's complaint."""


def expect(good, what):
    if not good:
        raise Failed(what)


class Adapter:
    """The client under test: a process that answers a line of JSON with one."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.lacks = self._read().get("lacks", [])

    def _read(self):
        line = self.process.stdout.readline()
        expect(line, "the adapter ended")
        return json.loads(line)

    def ask(self, do, **more):
        self.process.stdin.write(json.dumps({"do": do, **more}) + "\n")
        self.process.stdin.flush()
        answer = self._read()
        expect("failed" not in answer, f"{do}: {answer.get('failed')}")
        return answer

    def frame(self, data):
        return self.ask("frame", bytes=base64.b64encode(data).decode())["took"]

    def close(self):
        self.process.stdin.close()
        self.process.wait(ANSWER_S)
        self.process.stdout.close()


def same_numbers(name, found, wanted, tolerance):
    expect(len(found) == len(wanted), f"{name}: {len(found)} numbers instead of {len(wanted)}")
    for i, (a, b) in enumerate(zip(found, wanted)):
        expect(math.isclose(a, b, rel_tol=1e-6, abs_tol=tolerance), f"{name}[{i}] is {a} instead of {b}")


def same_state(found, wanted, step_m):
    """Single precision is enough for tools; positions and scalars to a thousandth of a step."""
    for name in ("epoch", "sequence", "tick", "removed"):
        expect(found[name] == wanted[name], f"{name} is {str(found[name])[:60]} instead of {str(wanted[name])[:60]}")
    same_numbers("positions_m", found["positions_m"], wanted["positions_m"], 1e-3 * step_m)
    for name in ("exposure", "charring", "stress", "temperature"):
        if name in wanted:
            same_numbers(name, found[name], wanted[name], 1e-6)
    expect(len(found["tools"]) == len(wanted["tools"]), "tools: another number")
    for one, other in zip(found["tools"], wanted["tools"]):
        for name in ("name", "sequence", "energized"):
            expect(one[name] == other[name], f"tool {other['name']}: {name} is {one[name]}")
        same_numbers(f"tool {other['name']}", one["position_m"], other["position_m"], 1e-6)


# ---- golden frames ------------------------------------------------------------------------------
class Golden:
    """Frames that the C encoder wrote, with what its decoder held after each of them (tests/protocol/node/golden.c)."""

    def __init__(self, folder, lacks):
        self.folder, self.channels = folder, channels()
        with open(os.path.join(folder, "streams.json"), encoding="utf-8") as file:
            manifest = json.load(file)
        self.description = {
            "session": "d1-golden", "session_number": manifest["session"], "profile": manifest["profile"],
            "epoch": "fedcba9876543210", "rate_hz": 60, "channels": [one["name"] for one in self.channels],
            "vertex_count": manifest["vertexCount"], "face_count": manifest["faceCount"],
            "origin_m": [-0.125, 0, 0], "step_m": 2.5e-5, "stress_step_pa": 10}
        self.streams = [one for one in manifest["streams"] if one["plain"] or "meshopt" not in lacks]

    def read(self, frame):
        with open(os.path.join(self.folder, frame["file"]), "rb") as file:
            return file.read()

    def state(self, golden):
        origin, step = self.description["origin_m"], self.description["step_m"]
        state = {name: golden[name] for name in ("epoch", "sequence", "tick")}
        state["positions_m"] = [origin[i % 3] + step * q for i, q in enumerate(golden["quantised"])]
        state["removed"] = [f for f in range(self.description["face_count"]) if golden["mask"][f // 32] >> f % 32 & 1]
        for one in self.channels:
            if "most" in one:
                scale = one.get("step") or self.description["stress_step_pa"]
                state[one["name"]] = [one["least"] + scale * n for n in golden[one["name"]]]
        state["tools"] = [{"name": tool["name"], "sequence": tool["sequence"], "energized": tool["energized"],
                           "position_m": tool["position"]} for tool in golden["tools"]]
        return state


def channels():
    with open(ASYNCAPI, encoding="utf-8") as file:
        found = json.load(file)["x-stream-channels"]
    return [{"step": 0, **one} if "most" in one else one for one in found]


def golden_streams(adapter, golden):
    """Each frame is taken, refused or found bad as the C decoder does, and leaves the same state."""
    for stream in golden.streams:
        adapter.ask("decode", description=golden.description)
        for frame in stream["frames"]:
            took, wanted = adapter.frame(golden.read(frame)), {"ok": "yes", "refused": "no", "corrupt": "bad"}
            expect(took == wanted[frame["expect"]], f"{frame['file']}: took is {took}")
            if frame["expect"] == "ok":
                same_state(adapter.ask("state"), golden.state(frame["state"]), golden.description["step_m"])


def deltas_after_a_gap(adapter, golden):
    """A delta that does not continue the held state is skipped, and the next key frame is taken."""
    stream = [frame for frame in golden.streams[-1]["frames"] if frame["expect"] == "ok"]
    adapter.ask("decode", description=golden.description)
    adapter.frame(golden.read(stream[0]))
    for frame in stream[2:6]:
        expect(adapter.frame(golden.read(frame)) == "no", "a delta after a gap was taken")
    same_state(adapter.ask("state"), golden.state(stream[0]["state"]), golden.description["step_m"])
    key = next(one for one in stream[1:] if golden.read(one)[5] == frames.KEY)
    expect(adapter.frame(golden.read(key)) == "yes", "the key frame after a gap was not taken")
    same_state(adapter.ask("state"), golden.state(key["state"]), golden.description["step_m"])


def other_epochs(adapter, golden):
    """A delta of another epoch is skipped, also where its base_sequence fits."""
    stream = [frame for frame in golden.streams[-1]["frames"] if frame["expect"] == "ok"]
    adapter.ask("decode", description=golden.description)
    adapter.frame(golden.read(stream[0]))
    delta = bytearray(golden.read(stream[1]))
    delta[16] ^= 1
    expect(adapter.frame(bytes(delta)) == "no", "a delta of another epoch was taken")


def older_key_frames(adapter, golden):
    """A key frame of the epoch that is held, and no newer, is skipped."""
    stream = [frame for frame in golden.streams[-1]["frames"] if frame["expect"] == "ok"]
    adapter.ask("decode", description=golden.description)
    for frame in stream[:4]:
        adapter.frame(golden.read(frame))
    expect(adapter.frame(golden.read(stream[0])) == "no", "an older key frame was taken")
    same_state(adapter.ask("state"), golden.state(stream[3]["state"]), golden.description["step_m"])


def other_streams(adapter, golden):
    """Frames of another session or profile are skipped."""
    for offset in (12, 64):
        adapter.ask("decode", description=golden.description)
        key = bytearray(golden.read(golden.streams[-1]["frames"][0]))
        key[offset] ^= 1
        expect(adapter.frame(bytes(key)) == "no", "a frame of another stream was taken")


def unknown_sections(adapter, golden):
    """A section of an unknown type is skipped, and the rest of the frame is taken."""
    first = golden.streams[-1]["frames"][0]
    key = bytearray(golden.read(first)) + struct.pack("<BBHI", UNKNOWN_SECTION, 0, 0, 4) + b"what"
    struct.pack_into("<I", key, 8, len(key))
    struct.pack_into("<H", key, 66, struct.unpack_from("<H", key, 66)[0] + 1)
    adapter.ask("decode", description=golden.description)
    expect(adapter.frame(bytes(key)) == "yes", "a frame with an unknown section was not taken")
    same_state(adapter.ask("state"), golden.state(first["state"]), golden.description["step_m"])


def cut_frames(adapter, golden):
    """A frame that ends early is bad, wherever it ends."""
    key = golden.read(golden.streams[-1]["frames"][0])
    for length in (0, 40, 72, 76, len(key) // 2, len(key) - 4):
        adapter.ask("decode", description=golden.description)
        expect(adapter.frame(key[:length]) == "bad", f"{length} bytes of {len(key)} were taken")


def bad_frames(adapter, golden):
    """After a bad frame nothing is held: the delta that was meant is skipped, and a key frame mends it."""
    stream = golden.streams[-1]["frames"]
    adapter.ask("decode", description=golden.description)
    for frame in stream[:3]:
        adapter.frame(golden.read(frame))
    delta = golden.read(stream[3])
    damaged = bytearray(delta)
    damaged[72 + 8 + 1] = 2  # components of the first section
    expect(adapter.frame(bytes(damaged)) == "bad", "a section of two components was taken")
    expect(adapter.frame(delta) == "no", "a delta was taken on what a bad frame had left")
    key = golden.read(stream[0])
    expect(adapter.frame(key) == "yes", "the key frame after a bad frame was not taken")
    same_state(adapter.ask("state"), golden.state(stream[0]["state"]), golden.description["step_m"])


GOLDEN = [golden_streams, bad_frames, deltas_after_a_gap, other_epochs, older_key_frames, other_streams, unknown_sections, cut_frames]


# ---- a daemon -----------------------------------------------------------------------------------
class Live:
    """A session of a daemon: the suite's own connection steers it and sees it beside the client under test."""

    def __init__(self, url, adapter):
        self.adapter = adapter
        self.own = Connection(url, channels())
        self.session = self.own.small_session(f"conformance-{os.getpid()}")
        adapter.ask("connect", url=url)

    def close(self):
        self.own.call("session.destroy", {"session": self.session})
        self.own.close()

    def call(self, method, **params):
        answer = self.adapter.ask("call", method=method, params={"session": self.session, **params})
        expect("result" in answer, f"{method} was refused: {answer}")
        return answer["result"]

    def advance(self, commands, ticks):
        """Lock-step: what happens does not depend on how fast the client is."""
        for command in commands:
            command["tool"] = "hook"
        return self.call("session.advance", commands=commands, ticks=ticks)["tick"]

    def compare(self, found, wanted):
        """Another profile has other sequences, and vertices that no drawn face uses are those of older frames."""
        drawn = self.own.decoder.drawn_vertices()
        both = []
        for state in (found, wanted):
            state = {**state, "sequence": 0, "positions_m": [state["positions_m"][3 * v + c] for v in drawn for c in range(3)]}
            state["exposure"] = [state["exposure"][v] for v in drawn]
            both.append(state)
        same_state(*both, self.own.decoder.description["step_m"])

    def compare_at(self, tick):
        self.compare(self.adapter.ask("settle", tick=tick), self.own.state_at(tick))


def requests(_adapter, live):
    """Requests are answered, and refusals come with their code and path."""
    expect(live.call("session.describe")["summary"]["session"] == live.session, "session.describe")
    for method, params, code, path in (
            ("session.describe", {"session": "d1-nothing-here"}, NO_SESSION, "params.session"),
            ("session.step", {"session": live.session, "ticks": -1}, BAD_VALUE, "params.ticks"),
            ("session.step", {"session": live.session, "what": 1}, BAD_VALUE, "params.what"),
            ("no.such", {}, NO_METHOD, None)):
        answer = live.adapter.ask("call", method=method, params=params)
        found = answer.get("error", {})
        expect(found.get("code") == code and (path is None or found.get("path") == path), f"{method}: {answer}")


def answers_by_id(adapter, live):
    """Of requests that are under way together each gets its own answer."""
    wanted = [("session.step", {"session": live.session, "ticks": 20}), ("session.list", {}),
              ("session.describe", {"session": "d1-nothing-here"}), ("session.describe", {"session": live.session})]
    answers = adapter.ask("together", calls=[{"method": m, "params": p} for m, p in wanted])["answers"]
    expect("tick" in answers[0].get("result", {}), "session.step")
    expect("sessions" in answers[1].get("result", {}), "session.list")
    expect("error" in answers[2], "session.describe of nothing")
    expect(answers[3].get("result", {}).get("summary", {}).get("session") == live.session, "session.describe")


def a_cut(adapter, live):
    """Joined, it holds what the session is, while tissue moves, parts and is driven."""
    params = {"session": live.session, "rate_hz": 1000, "channels": ["positions", "mask", "exposure", "tools"],
              **({"plain": True} if "meshopt" in adapter.lacks else {})}
    adapter.ask("join", params=params)
    live.own.join({**params, "plain": True})
    live.call("tool.take_over", tool="hook")
    live.compare_at(live.advance([{"method": "tool.move", "position_m": [-0.02, 0, 0.001], "rotation": AT_REST}], 60))
    for x in (-0.01, 0.0, 0.01, 0.02):
        live.compare_at(live.advance([
            {"method": "tool.energize", "energized": True},
            {"method": "tool.move", "position_m": [x, 0, 0.001], "rotation": AT_REST}], 12))
    live.compare_at(live.advance([{"method": "tool.energize", "energized": False}], 30))
    expect(live.own.decoder.state()["removed"], "the suite's own cut parts nothing")


def files(adapter, live):
    """A file that is announced comes whole, to the byte."""
    if "files" in adapter.lacks:
        return
    wanted = {"session": live.session, "format": "obj"}
    answer = adapter.ask("file", method="session.export", params=wanted)
    _, data = live.own.file("session.export", wanted)
    expect(answer["sha256"] == hashlib.sha256(data).hexdigest(), "session.export has other bytes")


def a_rewind(adapter, live):
    """After a rewind it holds the session's new epoch, without what the old one had."""
    before = adapter.ask("settle", tick=0)["epoch"]
    live.call("session.rewind", tick=0)
    live.own.state_of_another_epoch(int(before, 16))
    end_s = time.monotonic() + ANSWER_S
    while adapter.ask("settle", tick=0)["epoch"] == before and time.monotonic() < end_s:
        time.sleep(0.01)
    live.compare(adapter.ask("state"), live.own.decoder.state())


LIVE = [requests, answers_by_id, a_cut, files, a_rewind]


# ---- running ------------------------------------------------------------------------------------
def report(checks, *about):
    """Runs checks and prints TAP. The names of those that fail."""
    failures = []
    for number, check in enumerate(checks, 1):
        try:
            check(*about)
            print(f"ok {number} {check.__name__}", flush=True)
        except (Failed, Bad, Refused, TimeoutError, LookupError, TypeError, ValueError) as error:
            failures.append(check.__name__)
            print(f"not ok {number} {check.__name__}: {str(error) or repr(error)}", flush=True)
    print(f"1..{len(checks)}")
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--golden", required=True, help="a folder that cautery_golden has filled")
    parser.add_argument("--url", help="of a daemon whose admin everyone is: the checks of a connection, too")
    parser.add_argument("--only", action="append", metavar="CHECK", help="this check and no other; more than once")
    parser.add_argument("adapter", nargs="+")
    options = parser.parse_args()
    adapter = Adapter(options.adapter)
    golden = Golden(options.golden, adapter.lacks)
    live = Live(options.url, adapter) if options.url else None
    checks = [(check, about) for each, about in ((GOLDEN, golden), (LIVE, live)) if about for check in each]
    wanted = [functools.update_wrapper(functools.partial(check, adapter, about), check) for check, about in checks
              if not options.only or check.__name__ in options.only]
    failures = report(wanted)
    if live:
        live.close()
    adapter.close()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
