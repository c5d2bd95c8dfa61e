# SPDX-License-Identifier: GPL-3.0-or-later
"""Names the build targets that some tests run, so that no more than these is built for them.

Usage: programs_of_tests.py TREE REGEX

TREE is a configured build tree; nothing in it need be built. A test's programs are those that stand
in its command, its environment or its required files, as paths in the tree.
"""

import json
import os
import re
import subprocess
import sys

# Where CMake puts programs, libraries to preload included: a target is named as its file.
PROGRAM = r"/(?:bin|tests|fuzz|protocol/generate)/(?:lib)?([\w-]+)(?:\.so)?(?=[\";\s]|$)"
# Tests that look at, or install, what all folders but tests/ were compiled to, need this target.
ROOMS_TARGET = "cautery_rooms"
ROOMS = re.compile(r"/(?:objects\.txt|cmake_install\.cmake)")


def names(tree, regex):
    answer = subprocess.run(["ctest", "--show-only=json-v1", "-R", regex], cwd=tree, check=True,
                            stdout=subprocess.PIPE)
    return {test["name"] for test in json.loads(answer.stdout)["tests"]}


def definitions(tree):
    """Pairs of a test's name and a line of CMake that is about it."""
    for folder, subfolders, files in os.walk(tree):
        subfolders[:] = [name for name in subfolders if name not in ("CMakeFiles", "node_modules", "suite")]
        if "CTestTestfile.cmake" in files:
            with open(os.path.join(folder, "CTestTestfile.cmake"), encoding="utf-8") as file:
                yield from re.findall(r"^(?:add_test|set_tests_properties)\(\[=\[(.*?)\]=\] (.*)$",
                                      file.read(), re.MULTILINE)


def programs(tree, wanted):
    """The targets that the tests whose names are in `wanted` run."""
    found = set()
    paths = {re.escape(path) for path in (os.path.abspath(tree), os.path.realpath(tree))}
    program = re.compile(f"(?:{'|'.join(paths)}){PROGRAM}")
    for name, line in definitions(tree):
        if name in wanted:
            found.update(program.findall(line))
            if ROOMS.search(line):
                found.add(ROOMS_TARGET)
    return sorted(found)


def main(tree, regex):
    wanted = names(tree, regex)
    if not wanted:
        sys.exit(f"no test's name matches '{regex}'")
    print("\n".join(programs(tree, wanted)))


if __name__ == "__main__":
    main(*sys.argv[1:])
