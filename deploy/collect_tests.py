# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes one ctest suite out of several build trees, so that one ctest run reports on all of them.

Usage: collect_tests.py SUITE NAME TREE LABELS WITHOUT TIMEOUT_FACTOR

Appends the tests of the build tree TREE whose labels match the regular expression LABELS (all with
an empty one) and not WITHOUT (none with an empty one) to SUITE/CTestTestfile.cmake, each named
NAME.<test>, with NAME as a further label and its time limit multiplied by TIMEOUT_FACTOR.
"""

import json
import os
import subprocess
import sys

OWN_NAMES = ("DEPENDS", "FIXTURES_SETUP", "FIXTURES_REQUIRED", "FIXTURES_CLEANUP")
DERIVED = ("CONFIGURATIONS",)


def list_tests(tree, labels, without):
    command = ["ctest", "--show-only=json-v1"]
    command += ["--label-regex", labels] if labels else []
    command += ["--label-exclude", without] if without else []
    answer = subprocess.run(command, cwd=tree, check=True, stdout=subprocess.PIPE)
    return json.loads(answer.stdout)["tests"]


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


def render(test, suite_name, timeout_factor):
    if "command" not in test:
        sys.exit(f"{suite_name}: the program of test {test['name']} is not built")
    title = bracket(f"{suite_name}.{test['name']}")
    lines = [f"add_test({title} {' '.join(bracket(part) for part in test['command'])})"]
    for entry in test["properties"]:
        if entry["name"] not in DERIVED:
            value = cmake_value(adapt(suite_name, entry["name"], entry["value"], timeout_factor))
            lines.append(f"set_tests_properties({title} PROPERTIES {entry['name']} {value})")
    return "\n".join(lines) + "\n"


def main(suite, suite_name, tree, labels, without, timeout_factor):
    tests = list_tests(tree, labels, without)
    if not tests:
        sys.exit(f"{suite_name}: {tree} has no test with a label that matches '{labels}'")
    os.makedirs(suite, exist_ok=True)
    with open(os.path.join(suite, "CTestTestfile.cmake"), "a", encoding="utf-8") as file:
        file.writelines(render(test, suite_name, float(timeout_factor)) for test in tests)


if __name__ == "__main__":
    main(*sys.argv[1:])
