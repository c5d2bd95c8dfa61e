# SPDX-License-Identifier: GPL-3.0-or-later
"""Every C file is laid out as .clang-format says. Usage: formatting.py ROOT [--fix]"""

import re
import subprocess
import sys

import project

VERSION = "14"  # Debian 12's; other versions lay the same code out differently


def violations(root, files):
    answer = subprocess.run(["clang-format", "--dry-run", "-Werror", *files], cwd=root,
                            capture_output=True, text=True, check=False)
    places = re.findall(r"^(\S+?):(\d+):\d+: error", answer.stderr, re.MULTILINE)
    first_line = {name: line for name, line in reversed(places)}
    found = [f"{name}:{line}: not laid out as .clang-format says (build the target 'format')"
             for name, line in sorted(first_line.items())]
    return found if found or answer.returncode == 0 else [answer.stderr.strip()]


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
    project.finish(violations(root, files), len(files))


if __name__ == "__main__":
    main(sys.argv[1], "--fix" in sys.argv[2:])
