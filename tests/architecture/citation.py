# SPDX-License-Identifier: GPL-3.0-or-later
"""CITATION.cff, the entry for BibTeX in README.md and the build say the same title, author, version and licence.

Usage: citation.py ROOT
"""

import re
import sys

import project

PLACES = {  # what: {file: where it stands in it}
    "version": {"CMakeLists.txt": r"^project\(cautery VERSION (\S+)", "CITATION.cff": r"^version: (\S+)$",
                "README.md": r"^  version = \{(.*)\},$"},
    "title": {"CITATION.cff": r'^title: "(.*)"$', "README.md": r"^  title   = \{(.*)\},$"},
    "author": {"CITATION.cff": r"^authors:\n  - name: (.*)$", "README.md": r"^  author  = \{\{(.*)\}\},$"},
    "licence": {"CITATION.cff": r"^license: (\S+)$", "README.md": r"^## Licence\n\n([\w.-]+);"},
    "form": {"CITATION.cff": r"^cff-version: (1\.2\.0)$"},
}


def violations(root):
    found = []
    for what, places in PLACES.items():
        said = {}
        for name, where in places.items():
            matches = re.findall(where, project.read_text(root, name), re.MULTILINE)
            if len(matches) != 1:
                found.append(f"{name}: tells the {what} {len(matches)} times, not once")
            said[name] = matches
        if len({tuple(matches) for matches in said.values()}) != 1:
            found.append(f"the {what} differs: {said}")
    return found


if __name__ == "__main__":
    project.finish(violations(sys.argv[1]), len(PLACES))
