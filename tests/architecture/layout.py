# SPDX-License-Identifier: GPL-3.0-or-later
"""The top level holds the rooms and a few named files, nothing else. Usage: layout.py ROOT"""

import sys

import project

ALLOWED = {
    "CITATION.cff", "CMakeLists.txt", "CMakePresets.json", "CHANGELOG.md", "LICENSE", "README.md",
    "clients", "core", "deploy", "protocol", "server", "tests",
}


def violations(files):
    top_level = {name.split("/")[0] for name in files}
    return [f"{name}: not a name of the top level"
            for name in sorted(top_level - ALLOWED) if not name.startswith(".")]


if __name__ == "__main__":
    tracked = project.tracked_files(sys.argv[1])
    if tracked is None:
        project.skip("not a git checkout, so the project's files are not known")
    project.finish(violations(tracked), len(tracked))
