# SPDX-License-Identifier: GPL-3.0-or-later
"""What deploy/collect_tests.py makes of a tree: whose commands, under which names, in which order.

Usage: collect_tests_test.py DEPLOY CMAKE
"""

import json
import os
import subprocess
import sys
import tempfile

PROJECT = """cmake_minimum_required(VERSION 3.25)
project(small NONE)
enable_testing()
add_test(NAME quick COMMAND {says})
set_tests_properties(quick PROPERTIES LABELS unit TIMEOUT 7)
add_test(NAME timed COMMAND {says})
set_tests_properties(timed PROPERTIES LABELS unit RUN_SERIAL ON)
add_test(NAME parser COMMAND {says})
set_tests_properties(parser PROPERTIES LABELS fuzz TIMEOUT 130)
add_test(NAME room COMMAND {says})
set_tests_properties(room PROPERTIES LABELS tidy TIMEOUT 1800)
add_test(NAME hours COMMAND {says})
set_tests_properties(hours PROPERTIES LABELS "unit;long")
add_test(NAME daemon COMMAND {says})
set_tests_properties(daemon PROPERTIES LABELS e2e)
"""


def make_tree(cmake, folder, says):
    """A configured tree in FOLDER/build whose tests run the program `says`."""
    os.makedirs(folder)
    with open(os.path.join(folder, "CMakeLists.txt"), "w", encoding="utf-8") as file:
        file.write(PROJECT.format(says=says))
    subprocess.run([cmake, "-S", folder, "-B", os.path.join(folder, "build")], check=True, stdout=subprocess.DEVNULL)
    return os.path.join(folder, "build")


def collect(deploy, suite, *arguments, options=()):
    script = os.path.join(deploy, "collect_tests.py")
    subprocess.run([sys.executable, "-B", script, *options, suite, *arguments], check=True)
    said = subprocess.run(["ctest", "--show-only=json-v1"], cwd=suite, check=True, stdout=subprocess.PIPE).stdout
    return {test["name"]: {"command": test.get("command"), **{entry["name"]: entry["value"]
                           for entry in test["properties"]}} for test in json.loads(said)["tests"]}


def commands_are_the_trees_own(deploy, cmake, folder):
    """Tests that build leave trees within the tree, whose tests have the same names."""
    tree = make_tree(cmake, os.path.join(folder, "own"), "true")
    make_tree(cmake, os.path.join(tree, "tests", "steps", "copy"), "false")
    tests = collect(deploy, os.path.join(folder, "own-suite"), "release", tree, "", "", "1")
    for name in ("quick", "timed", "parser", "hours"):
        assert os.path.basename(tests[f"release.{name}"]["command"][-1]) == "true", tests[f"release.{name}"]


def labels_limits_and_slots(deploy, cmake, folder):
    tree = make_tree(cmake, os.path.join(folder, "slots"), "true")
    tests = collect(deploy, os.path.join(folder, "slots-suite"), "asan", tree, "unit|fuzz|tidy|e2e", "long", "4", "true")
    assert set(tests) == {f"asan.{name}" for name in ("build", "quick", "timed", "parser", "room", "daemon")}, set(tests)
    assert tests["asan.quick"]["TIMEOUT"] == 28 and "asan" in tests["asan.quick"]["LABELS"], tests["asan.quick"]
    assert tests["asan.quick"]["FIXTURES_REQUIRED"] == ["asan.tree"], tests["asan.quick"]
    # ctest does not name what is one
    slots = [tests[f"asan.{name}"].get("PROCESSORS", 1) for name in ("quick", "timed", "parser", "build", "daemon")]
    assert slots == [4, 11, 4, 1, 3], slots
    costs = [tests[f"asan.{name}"]["COST"] for name in ("build", "timed", "quick", "room", "parser")]
    assert costs == sorted(costs, reverse=True) and len(set(costs)) == len(costs), costs
    assert tests["asan.room"]["command"][0].endswith("chrt"), tests["asan.room"]
    # what measures times is waited for, but not by what fills the machine beside it
    waiting = {name for name, test in tests.items() if "asan.timed" in test.get("DEPENDS", [])}
    assert waiting == {f"asan.{name}" for name in ("quick", "parser", "daemon")}, waiting
    assert tests["asan.daemon"]["command"] == tests["asan.quick"]["command"], tests["asan.daemon"]
    # where times are measured, a daemon has a core
    plain = collect(deploy, os.path.join(folder, "plain-suite"), "release", tree, "e2e", "", "1")
    assert plain["release.daemon"].get("PROCESSORS", 1) == 4, plain
    # by the tests of another tree, too
    later = collect(deploy, os.path.join(folder, "slots-suite"), "tsan", tree, "unit", "long", "4", "true")
    assert {"asan.timed", "tsan.timed"} < set(later["tsan.quick"]["DEPENDS"]), later["tsan.quick"]
    assert later["tsan.timed"]["DEPENDS"] == ["tsan.build"], later["tsan.timed"]


def named_tests_are_left_out(deploy, cmake, folder):
    """Those of a file. A name that no test has is an error: its test was renamed, and would run again."""
    tree = make_tree(cmake, os.path.join(folder, "named"), "true")
    names = os.path.join(folder, "later.txt")
    with open(names, "w", encoding="utf-8") as file:
        file.write("# seconds\nquick 20\n\n")
    tests = collect(deploy, os.path.join(folder, "named-suite"), "release", tree, "unit", "", "1", options=["--without-names", names])
    assert set(tests) == {"release.timed", "release.hours"}, set(tests)
    with open(names, "a", encoding="utf-8") as file:
        file.write("quik 20\n")
    script = [sys.executable, "-B", os.path.join(deploy, "collect_tests.py"), "--without-names", names]
    done = subprocess.run([*script, os.path.join(folder, "typo-suite"), "release", tree, "unit", "", "1"],
                          stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1 and "does not have: quik" in done.stderr, done


def builds_what_the_tests_run(deploy, cmake, folder):
    """Of the programs in the tree, those of the tests that were chosen."""
    tree = make_tree(cmake, os.path.join(folder, "programs"), "${CMAKE_BINARY_DIR}/tests/test_chosen")
    with open(os.path.join(folder, "programs", "CMakeLists.txt"), "a", encoding="utf-8") as file:
        file.write("add_test(NAME other COMMAND ${CMAKE_BINARY_DIR}/tests/test_other)\n")
    subprocess.run([cmake, tree], check=True, stdout=subprocess.DEVNULL)
    tests = collect(deploy, os.path.join(folder, "programs-suite"), "tsan", tree, "unit", "", "1", "make", "programs", "-k")
    assert tests["tsan.build"]["command"][-3:] == ["make", "test_chosen", "-k"], tests["tsan.build"]


def main(deploy, cmake):
    with tempfile.TemporaryDirectory() as folder:
        for check in (commands_are_the_trees_own, labels_limits_and_slots, named_tests_are_left_out, builds_what_the_tests_run):
            check(deploy, cmake, folder)
            print("ok", check.__name__)


if __name__ == "__main__":
    main(*sys.argv[1:])
