# SPDX-License-Identifier: GPL-3.0-or-later
"""The project's files, and how an architecture test ends."""

import os
import subprocess
import sys

SKIPPED = 77  # ctest's SKIP_RETURN_CODE


def tracked_files(root):
    """Paths relative to `root` of the files git tracks that exist; None outside a git checkout."""
    command = ["git", "-c", "safe.directory=*", "-C", root, "ls-files", "-z"]
    try:
        listing = subprocess.run(command, capture_output=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None
    names = [name for name in listing.decode().split("\0") if name]
    return sorted(name for name in names if os.path.isfile(os.path.join(root, name)))


def all_files(root):
    """tracked_files(), or every file outside build trees and dot folders where git knows none."""
    files = tracked_files(root)
    if files is not None:
        return files
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = [f for f in folders if not f.startswith((".", "build")) and f != "node_modules"]
        found += [os.path.relpath(os.path.join(folder, name), root) for name in names]
    return sorted(found)


def read_text(root, name):
    """The file's text, or None if it is not UTF-8 text."""
    with open(os.path.join(root, name), "rb") as file:
        data = file.read()
    if b"\0" in data:
        return None
    try:
        return data.decode()
    except UnicodeDecodeError:
        return None


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def finish(violations, checked):
    """Prints the violations and exits: 1 with any, 1 if nothing was checked, else 0."""
    for violation in violations:
        print(violation)
    print(f"{checked} checked, {len(violations)} violations")
    sys.exit(1 if violations or not checked else 0)
