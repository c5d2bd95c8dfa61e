# SPDX-License-Identifier: GPL-3.0-or-later
"""Each known bug names the test that shows it, and that test exists. Usage: known_bugs.py ROOT"""

import re
import sys

import project

PAGE = ".github/KNOWN_BUGS.md"
NAMED = re.compile(r"\bNAME (\w+)")


def bugs_of(page):
    """The last cell of each line of the table, its head left out."""
    lines = [line for line in page.splitlines() if line.startswith("|")]
    return [line.strip().strip("|").split("|")[-1].strip() for line in lines[2:]]


def violations(root, files):
    tests = {name for file in files if file.startswith("tests/") and file.endswith("CMakeLists.txt")
             for name in NAMED.findall(project.read_text(root, file))}
    found = []
    for number, cell in enumerate(bugs_of(project.read_text(root, PAGE)), 1):
        named = re.fullmatch(r"`(\w+)`", cell)
        if not named or named.group(1) not in tests:
            found.append(f"{PAGE}: bug {number} names {cell or 'nothing'}, which is no test")
    return found


if __name__ == "__main__":
    every = project.all_files(sys.argv[1])
    project.finish(violations(sys.argv[1], every), len(bugs_of(project.read_text(sys.argv[1], PAGE))))
