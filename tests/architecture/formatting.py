# SPDX-License-Identifier: GPL-3.0-or-later
"""Every C file is laid out as .clang-format says. Usage: formatting.py ROOT [--fix]

Examples and tables in comments (three blanks or more after the //) are left alone by clang-format: it
would fill their lines like prose. So that they stay within the width all the same, it is checked here.
"""

import os
import re
import subprocess
import sys

import project

WIDTH = 100  # ColumnLimit of .clang-format
TAB = 4
KEPT = re.compile(r"^\s*// {3,}\S")  # as CommentPragmas of .clang-format
VERSION = "14"  # Debian 12's; other versions lay the same code out differently


def violations(root, files):
    answer = subprocess.run(["clang-format", "--dry-run", "-Werror", *files], cwd=root,
                            capture_output=True, text=True, check=False)
    places = re.findall(r"^(\S+?):(\d+):\d+: error", answer.stderr, re.MULTILINE)
    first_line = {name: line for name, line in reversed(places)}
    found = [f"{name}:{line}: not laid out as .clang-format says (build the target 'format')"
             for name, line in sorted(first_line.items())]
    return found if found or answer.returncode == 0 else [answer.stderr.strip()]


def wide_examples(name, text):
    return [f"{name}:{number}: an example or table in a comment beyond column {WIDTH}: break it by hand"
            for number, line in enumerate(text.splitlines(), 1)
            if KEPT.match(line) and len(line.expandtabs(TAB)) > WIDTH]


def all_wide_examples(root, files):
    found = []
    for name in files:
        with open(os.path.join(root, name), encoding="utf-8") as file:
            found += wide_examples(name, file.read())
    return found


def main(root, fix):
    files = [n for n in project.all_files(root) if n.endswith((".c", ".h"))]
    try:
        answer = subprocess.run(["clang-format", "--version"], capture_output=True, text=True, check=True)
    except OSError:
        project.skip("clang-format is not installed")
    version = re.search(r"version (\d+)", answer.stdout).group(1)
    if version != VERSION:
        project.skip(f"clang-format {version} is installed, the layout is that of {VERSION}")
    if fix:
        sys.exit(subprocess.run(["clang-format", "-i", *files], cwd=root, check=False).returncode)
    project.finish(violations(root, files) + all_wide_examples(root, files), len(files))


if __name__ == "__main__":
    main(sys.argv[1], "--fix" in sys.argv[2:])
