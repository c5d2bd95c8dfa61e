# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes ctest's lines on and says which tests are running where ctest is silent for some seconds.

Usage: ctest ... | follow_tests.py LOGS

On a terminal one line changes every second, elsewhere there is a new one every so often. How far a
test NAME.build is, is read off LOGS/build-NAME.log. Before ctest's closing lines says once more how
each failed test ended: its own lines are thousands above by then.
"""

import collections
import os
import re
import select
import sys
import time

SILENT_S = 5
LINE_EVERY_S = 15  # where it is not a terminal
TERMINAL_COLUMNS = 100
LAST_LINES = 40  # of a failed test, said again

START = re.compile(rb"^\s*Start\s+\d+: (\S+)")
RESULT = re.compile(rb"^\s*\d+/\d+ Test\s+#\d+: (\S+)")
CLOSING = re.compile(rb"^\d+% tests passed")
FAILED = re.compile(rb"\*\*\*(Failed|Timeout|Exception|Not Run)")
STEPS = re.compile(rb"^\[(\d+)/(\d+)\] |^\[ *(\d+)%\] ", re.MULTILINE)


def percent(log):
    """How much of a tree is built, by the last step that ninja or make has told."""
    try:
        with open(log, "rb") as file:
            steps = STEPS.findall(file.read())
    except OSError:
        return ""
    if not steps:
        return ""
    done, count, share = steps[-1]
    return f" {share.decode() if share else 100 * int(done) // int(count)} %"


class Follower:
    def __init__(self, logs):
        self.logs, self.terminal = logs, sys.stdout.isatty()
        self.started, self.running, self.told = time.monotonic(), {}, time.monotonic()
        self.failed, self.failing = {}, None  # last lines by test; the test whose lines come now

    def take(self, line):
        start, result = START.match(line), RESULT.match(line)
        if start:
            self.running[start.group(1).decode()] = time.monotonic()
        if result:
            self.running.pop(result.group(1).decode(), None)
        self.keep_failed(line, start, result)
        if self.terminal:
            sys.stdout.write("\r\033[K")
        sys.stdout.buffer.write(line)
        sys.stdout.flush()
        self.told = time.monotonic()

    def keep_failed(self, line, start, result):
        closing = CLOSING.match(line)
        if closing:
            self.tell_failed()
        if result and FAILED.search(line):
            self.failing = self.failed[result.group(1).decode()] = collections.deque(maxlen=LAST_LINES)
        elif start or result or closing:
            self.failing = None
        elif self.failing is not None:
            self.failing.append(line)

    def tell_failed(self):
        for name, lines in self.failed.items():
            print(f"\n== how {name} ended", flush=True)
            sys.stdout.buffer.write(b"".join(lines))
            sys.stdout.flush()

    def describe(self, name, since):
        build = re.fullmatch(r"(\w+)\.build", name)
        share = percent(os.path.join(self.logs, f"build-{build.group(1)}.log")) if build else ""
        return f"{name}{share} ({time.monotonic() - since:.0f} s)"

    def tell(self):
        silent = time.monotonic() - self.told
        if not self.running or silent < (SILENT_S if self.terminal else LINE_EVERY_S):
            return
        minutes, seconds = divmod(int(time.monotonic() - self.started), 60)
        line = f"   [{minutes}:{seconds:02}] running: " + ", ".join(
            self.describe(name, since) for name, since in self.running.items())
        if self.terminal:
            print("\r\033[K" + line[:TERMINAL_COLUMNS], end="", flush=True)
        else:
            print(line, flush=True)
            self.told = time.monotonic()


def main(logs):
    follower, rest = Follower(logs), b""
    while True:
        if not select.select([0], [], [], 1)[0]:
            follower.tell()
            continue
        piece = os.read(0, 65536)
        if not piece:
            break
        *lines, rest = (rest + piece).split(b"\n")
        for line in lines:
            follower.take(line + b"\n")
    if rest:
        follower.take(rest)


if __name__ == "__main__":
    main(sys.argv[1])
