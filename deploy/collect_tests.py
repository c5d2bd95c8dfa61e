# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes one ctest suite out of several build trees, so that one ctest run reports on all of them.

Usage: collect_tests.py [--without-names FILE] SUITE NAME TREE LABELS WITHOUT TIMEOUT_FACTOR [BUILD COMMAND...]

Appends the tests of the configured build tree TREE whose labels match the regular expression LABELS
(all with an empty one) and not WITHOUT (none with an empty one) to SUITE/CTestTestfile.cmake, each
named NAME.<test>, with NAME as a further label and its time limit multiplied by TIMEOUT_FACTOR. With
a command, building the tree is a test of its own, NAME.build, which the others wait for. In place of
the word "programs" the command gets the targets that these tests run. FILE names tests to leave out
besides: the first word of each line that is no comment.

How the tests share the machine. The suite is run with `--parallel 12`, six slots for each of two
cores. First comes what measures times (RUN_SERIAL in its tree): one at a time, with eleven slots. What
needs no particular speed may run beside it: building (one tree at a time) and clang-tidy, which take
one slot and run in the kernel's idle class, so that they have whatever the others leave of both cores
and nothing else. Every other test depends on all that measure times: ctest starts whatever fits, and
would let those wait for the end. Then three ordinary tests run at a time, or four of those that wait
more than they compute (a sanitizer's e2e tests), the longest time limits first; fuzzing comes last.
"""

import json
import os
import re
import subprocess
import sys

from programs_of_tests import programs

OWN_NAMES = ("DEPENDS", "FIXTURES_SETUP", "FIXTURES_REQUIRED", "FIXTURES_CLEANUP")
SCHEDULE = ("COST", "PROCESSORS", "RUN_SERIAL")
DERIVED = ("CONFIGURATIONS",)

TIMING_SLOTS, ORDINARY_SLOTS, WAITING_SLOTS, FILLER_SLOTS = 11, 4, 3, 1
WAITING_LABEL, FILLER_LABEL, LAST_LABEL = "e2e", "tidy", "fuzz"
TIMING_NAMES = "measure_times.txt"  # in the suite: what the others wait for
GIVING_WAY = ["chrt", "--idle", "0"]  # below any nice value
BUILD_COST, TIMING_COST = 1e6, 1e5  # above any time limit, which is the cost of the others
UNKNOWN_COST = 60  # of a test without a time limit
LATE_COST_PER_S = 1e-4  # below any other test; of these clang-tidy, which takes a minute, before fuzzing
BUILD_LIMIT_S = 7200  # it gives way to all else


def list_tests(tree, labels, without):
    command = ["ctest", "--show-only=json-v1"]
    command += ["--label-regex", labels] if labels else []
    command += ["--label-exclude", without] if without else []
    answer = subprocess.run(command, cwd=tree, check=True, stdout=subprocess.PIPE)
    return json.loads(answer.stdout)["tests"]


def named_in(path):
    """The tests that a file like tests/later.txt names."""
    with open(path, encoding="utf-8") as file:
        return {line.split()[0] for line in file if line.strip() and not line.startswith("#")}


def is_tree(folder):
    return os.path.exists(os.path.join(folder, "CMakeCache.txt"))


def written_commands(tree):
    """Each test's command as CMake wrote it: ctest tells that of a program which is built, only.

    Trees within the tree are not its own: tests that build something leave theirs there, with tests of
    the same names.
    """
    commands = {}
    for folder, subfolders, files in os.walk(tree):
        subfolders[:] = [name for name in subfolders if name not in ("CMakeFiles", "node_modules", "suite")
                         and not is_tree(os.path.join(folder, name))]
        if "CTestTestfile.cmake" in files:
            with open(os.path.join(folder, "CTestTestfile.cmake"), encoding="utf-8") as file:
                commands.update(re.findall(r"^add_test\(\[=\[(.*?)\]=\] (.*)\)$", file.read(), re.MULTILINE))
    return commands


def bracket(text):
    """`text` as a CMake argument in which nothing is special."""
    level = 1
    while "]" + "=" * level + "]" in text:
        level += 1
    return "[" + "=" * level + "[" + text + "]" + "=" * level + "]"


def cmake_value(value):
    if isinstance(value, bool):
        return "ON" if value else "OFF"
    if isinstance(value, list):
        return bracket(";".join(str(part).replace(";", "\\;") for part in value))
    return bracket(str(value))


def adapt(suite_name, name, value, timeout_factor):
    if name in OWN_NAMES:
        return [f"{suite_name}.{part}" for part in (value if isinstance(value, list) else [value])]
    if name == "TIMEOUT":
        return value * timeout_factor
    if name == "LABELS":
        return [*value, suite_name]
    return value


def measures_times(properties):
    return bool(properties.get("RUN_SERIAL"))


def schedule(properties, sanitized):
    """How much of the machine a test takes, and when: further properties."""
    limit, labels = properties.get("TIMEOUT", 0), properties.get("LABELS", [])
    if FILLER_LABEL in labels:
        return {"PROCESSORS": FILLER_SLOTS, "COST": LATE_COST_PER_S * limit}
    if LAST_LABEL in labels:
        return {"PROCESSORS": ORDINARY_SLOTS, "COST": LATE_COST_PER_S * limit}
    if measures_times(properties):
        return {"PROCESSORS": TIMING_SLOTS, "COST": TIMING_COST + limit}
    waits = sanitized and WAITING_LABEL in labels
    return {"PROCESSORS": WAITING_SLOTS if waits else ORDINARY_SLOTS, "COST": limit or UNKNOWN_COST}


def define(name, command, properties):
    lines = [f"add_test({bracket(name)} {command})"]
    for key, value in properties.items():
        lines.append(f"set_tests_properties({bracket(name)} PROPERTIES {key} {cmake_value(value)})")
    return "\n".join(lines) + "\n"


def given_properties(test):
    return {entry["name"]: entry["value"] for entry in test["properties"]}


def render(test, command, suite_name, timeout_factor, needs_build, timing):
    """`timing`: the tests of the suite that measure times, which this one waits for if it is none of
    them, gives way to nothing and sets nothing up for them."""
    given = given_properties(test)
    properties = {name: adapt(suite_name, name, value, timeout_factor)
                  for name, value in given.items() if name not in DERIVED + SCHEDULE}
    gives_way = FILLER_LABEL in given.get("LABELS", [])
    properties.update(schedule(given, timeout_factor > 1))
    if needs_build:
        properties.setdefault("FIXTURES_REQUIRED", []).append(f"{suite_name}.tree")
    if gives_way:
        command = " ".join([*GIVING_WAY, command])
    elif not measures_times(given) and "FIXTURES_SETUP" not in given:
        properties["DEPENDS"] = [*properties.get("DEPENDS", []), *timing]
    return define(f"{suite_name}.{test['name']}", command, properties)


def with_programs(command, tree, tests):
    """`command` with the targets that the tests run in place of the word "programs"."""
    names = {test["name"] for test in tests}
    return [part for word in command for part in (programs(tree, names) if word == "programs" else [word])]


def render_build(suite_name, command):
    return define(f"{suite_name}.build", " ".join(bracket(part) for part in [*GIVING_WAY, *command]), {
        "LABELS": [suite_name, "build"], "FIXTURES_SETUP": f"{suite_name}.tree", "RESOURCE_LOCK": "build",
        "PROCESSORS": FILLER_SLOTS, "COST": BUILD_COST, "TIMEOUT": BUILD_LIMIT_S})


def known_timing(suite, further):
    """The tests that measure times of all trees so far, with these."""
    with open(os.path.join(suite, TIMING_NAMES), "a+", encoding="utf-8") as file:
        file.writelines(f"{name}\n" for name in further)
        file.seek(0)
        return file.read().split()


def without_named(tests, path, tree):
    left_out, known = named_in(path), {test["name"] for test in list_tests(tree, "", "")}
    if left_out - known:
        sys.exit(f"{path} names tests that {tree} does not have: {', '.join(sorted(left_out - known))}")
    return [test for test in tests if test["name"] not in left_out]


def main(suite, suite_name, tree, labels, without, timeout_factor, *build, without_names=None):
    tests, commands = list_tests(tree, labels, without), written_commands(tree)
    if without_names:
        tests = without_named(tests, without_names, tree)
    if not tests:
        sys.exit(f"{suite_name}: {tree} has no test with a label that matches '{labels}'")
    os.makedirs(suite, exist_ok=True)
    timing = known_timing(suite, [f"{suite_name}.{test['name']}" for test in tests if measures_times(given_properties(test))])
    with open(os.path.join(suite, "CTestTestfile.cmake"), "a", encoding="utf-8") as file:
        if build:
            file.write(render_build(suite_name, with_programs(build, tree, tests)))
        file.writelines(render(test, commands[test["name"]], suite_name, float(timeout_factor), bool(build), timing)
                        for test in tests)


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if arguments[0] == "--without-names":
        main(*arguments[2:], without_names=arguments[1])
    else:
        main(*arguments)
