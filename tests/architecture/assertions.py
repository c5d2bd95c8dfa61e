# SPDX-License-Identifier: GPL-3.0-or-later
"""Where assertions are on, every room has some; where they are off, no object has one.

Usage: assertions.py OBJECT_LIST ON|OFF (OBJECT_LIST as for symbols.py)
"""

import subprocess
import sys

import project
import symbols

ROOMS = ("core", "protocol", "server")


def asserting(paths):
    """Those of the object files that call what a failed assertion calls."""
    listing = subprocess.run(["nm", "--format=posix", "--print-file-name", "--undefined-only", *paths],
                             capture_output=True, check=True, text=True).stdout
    found = set()
    for line in listing.splitlines():
        path, _, symbol = line.partition(": ")
        if symbol.split()[0] == symbols.FAILED:
            found.add(path)
    return found


def violations(objects, on):
    """`objects`: (room, path) pairs."""
    found = []
    with_one = asserting([path for _, path in objects])
    if not on:
        return [f"{symbols.source_of(room, path)}: has an assertion, and they are off in this build"
                for room, path in objects if path in with_one]
    rooms = {room for room, _ in objects}
    for room in ROOMS:
        if room in rooms and not any(path in with_one for owner, path in objects if owner == room):
            found.append(f"{room}: no object has an assertion, and they are on in this build")
    return found


if __name__ == "__main__":
    pairs, missing = symbols.read_list(sys.argv[1])
    project.finish(missing or violations(pairs, sys.argv[2] == "ON"), len(pairs))
