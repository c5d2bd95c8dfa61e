# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules for every text file: licence line, no leftovers, no path or host of one machine, and pages
(.md) that sources cite are in the repository.

Usage: text_rules.py ROOT
"""

import os
import re
import sys

import licences
import project

# Written in pieces, so that this file passes its own rules.
LEFTOVER = re.compile(r"\b(TO" r"DO|FIX" r"ME|XX" r"X)\b")
MACHINE_PATH = re.compile(r"(?<![\w.~-])/(wo" r"rk|ro" r"ot|home/\w+)/")
REGISTRY = re.compile(r"registry\.(np" r"mjs|ya" r"rnpkg)\.|art" r"ifactory", re.IGNORECASE)

PAGE = re.compile(r"(?<![\w/.:\"'$}*-])((?:[\w-]+/)*[\w-]+\.md)\b(?![.\w])")

LICENCE_LINE = "SPDX-License-Identifier: "
LICENSED = {".c", ".def", ".h", ".hpp", ".cc", ".cpp", ".idl", ".mjs", ".py", ".sh", ".ts"}
LICENCE_WITHIN_LINES = 3  # a #! line may come first

# Checksums can spell anything.
NO_LEFTOVER_RULE = {"package-lock.json"}


def needs_licence(name, text):
    extension = os.path.splitext(name)[1]
    return extension in LICENSED or (extension == "" and text.startswith("#!"))


def cites_pages(name):
    return os.path.splitext(name)[1] in LICENSED and not name.startswith("tests/architecture/")


def missing_pages(name, text, pages):
    """A page is cited from the top of the repository, or from the citing file's own folder or one above."""
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        for page in PAGE.findall(line):
            folder = os.path.dirname(name)
            places = {page}
            while folder:
                places.add(f"{folder}/{page}")
                folder = os.path.dirname(folder)
            if not places & pages:
                found.append(f"{name}:{number}: cites {page}, which is not in the repository")
    return found


def violations_of(name, text):
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        where = f"{name}:{number}"
        if LEFTOVER.search(line) and os.path.basename(name) not in NO_LEFTOVER_RULE:
            found.append(f"{where}: leftover marker: {line.strip()[:80]}")
        if MACHINE_PATH.search(line):
            found.append(f"{where}: path of one machine: {line.strip()[:80]}")
        if REGISTRY.search(line):
            found.append(f"{where}: package registry host: {line.strip()[:80]}")
    head = text.splitlines()[:LICENCE_WITHIN_LINES]
    licence_line = LICENCE_LINE + licences.licence_of(name)
    if needs_licence(name, text) and not any(licence_line in line for line in head):
        found.append(f"{name}: no line '{licence_line}' at the top")
    return found


def violations(root, files):
    found = []
    pages = {name for name in files if name.endswith(".md")}
    for name in files:
        text = project.read_text(root, name)
        if text is not None:
            found += violations_of(name, text)
        if text is not None and cites_pages(name):
            found += missing_pages(name, text, pages)
    return found


if __name__ == "__main__":
    every = project.all_files(sys.argv[1])
    project.finish(violations(sys.argv[1], every), len(every))
