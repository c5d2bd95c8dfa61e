# SPDX-License-Identifier: GPL-3.0-or-later
"""What deploy/follow_tests.py makes of ctest's lines: all of them, and before the last how failed tests ended.

Usage: follow_tests_test.py DEPLOY
"""

import os
import subprocess
import sys
import tempfile

DEPLOY, = sys.argv[1:]

LINES = [
    "    Start 1: asan.first",
    "1/3 Test #1: asan.first ......***Failed    1.00 sec",
    *[f"line {i} of the first" for i in range(60)],
    "    Start 2: asan.second",
    "2/3 Test #2: asan.second ......   Passed    1.00 sec",
    "    Start 3: asan.third",
    "3/3 Test #3: asan.third ......***Timeout   1.00 sec",
    "the third's line",
    "",
    "33% tests passed, 2 tests failed out of 3",
    "",
    "Errors while running CTest",
]

with tempfile.TemporaryDirectory() as logs:
    said = subprocess.run([sys.executable, os.path.join(DEPLOY, "follow_tests.py"), logs], check=True, text=True,
                          input="\n".join(LINES) + "\n", stdout=subprocess.PIPE).stdout.split("\n")

closing = said.index("33% tests passed, 2 tests failed out of 3")
again = said.index("== how asan.first ended")
before = [line for line in said[:again] if line]
assert before == [line for line in LINES[:LINES.index("33% tests passed, 2 tests failed out of 3")] if line], before
assert said[again + 1:again + 41] == [f"line {i} of the first" for i in range(20, 60)], said[again:]
third = said.index("== how asan.third ended")
assert again < third < closing and said[third + 1] == "the third's line", said[again:]
assert "== how asan.second ended" not in said
assert said[closing + 2] == "Errors while running CTest", "ctest has the last word"
