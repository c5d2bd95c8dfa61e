# SPDX-License-Identifier: GPL-3.0-or-later
"""The server's rooms know whom their link lines name and their page shows.
Usage: arrows.py ROOT OBJECT_LIST LINK_LIST

Each folder of server/ is a target. LINK_LIST has one line per target: folder, '|', target, '|', the
targets that it links, separated by ','. A room includes and calls only what it links, and the table
of rooms in server/README.md names the same rooms for each.
"""

import os
import re
import sys

import circles
import includes
import project
import symbols

SERVER = "server/"
PAGE = "server/README.md"
# A row of the table: | `room/` | what it is | `room/`, `room/` |
ROW = re.compile(r"^\| `(\w+)/` \|.*\|([^|]*)\|$", re.MULTILINE)


def read_links(path):
    """[(folder, target, targets that it links)]"""
    with open(path, encoding="utf-8") as listing:
        rows = [line.strip().split("|") for line in listing if line.count("|") == 2]
    return [(folder, target, [t.replace("cautery::", "cautery_") for t in links.split(",") if t])
            for folder, target, links in rows]


def linked_rooms(links):
    """{room: rooms that it links}; a room's programs and libraries count together."""
    room_of = {target: folder[len(SERVER):] for folder, target, _ in links
               if folder.startswith(SERVER)}
    rooms = {room: set() for room in room_of.values()}
    for _, target, named in links:
        room = room_of.get(target)
        if room:
            rooms[room] |= {room_of[other] for other in named if room_of.get(other, room) != room}
    return rooms


def room_of(name):
    parts = name.split("/")
    return parts[1] if name.startswith(SERVER) and len(parts) > 2 else None


def included_rooms(root, files):
    """[(file, room that it includes from)]"""
    folders = {room_of(name) for name in files}
    found = []
    for name in files:
        if room_of(name) and name.endswith((".c", ".h")):
            for _, header in includes.INCLUDE.findall(project.read_text(root, name) or ""):
                room = header.split("/")[0]
                if "/" in header and room in folders and room != room_of(name):
                    found.append((name, room))
    return found


def called_rooms(objects):
    """[(file, room whose function it calls)]"""
    return sorted({(source, room_of(other)) for source, others in circles.needs_of(objects).items()
                   for other in others
                   if room_of(source) and room_of(other) and room_of(source) != room_of(other)})


def undrawn(uses, rooms, does):
    return sorted({f"{name}: {does} {room}/, which server/{room_of(name)}/CMakeLists.txt does not link"
                   for name, room in uses if room not in rooms.get(room_of(name), set())})


def drawn_rooms(page):
    """{room: rooms that the table names}"""
    return {room: set(re.findall(r"`(\w+)/`", knows)) for room, knows in ROW.findall(page)}


def page_violations(rooms, drawn):
    found = []
    for room in sorted(set(rooms) | set(drawn)):
        if room not in drawn:
            found.append(f"{PAGE}: the table of rooms lacks {room}/")
        elif room not in rooms:
            found.append(f"{PAGE}: draws {room}/, which is no target of its own")
        elif rooms[room] != drawn[room]:
            found.append(f"{PAGE}: draws {room}/ as knowing {', '.join(sorted(drawn[room])) or 'no room'}; "
                         f"it links {', '.join(sorted(rooms[room])) or 'none'}")
    return found


def violations(root, files, objects, links):
    rooms = linked_rooms(links)
    folders = {room_of(name) for name in files if name.endswith((".c", ".h"))} - {None}
    found = [f"server/{room}: is no target of its own" for room in sorted(folders - set(rooms))]
    found += undrawn(included_rooms(root, files), rooms, "includes from")
    found += undrawn(called_rooms(objects), rooms, "calls")
    found += ["rooms link each other in a circle: " + ", ".join(c) for c in circles.circles(rooms)]
    return found + page_violations(rooms, drawn_rooms(project.read_text(root, PAGE) or ""))


if __name__ == "__main__":
    every = project.all_files(sys.argv[1])
    pairs, missing = symbols.read_list(sys.argv[2])
    project.finish(missing or violations(sys.argv[1], every, pairs, read_links(sys.argv[3])), len(pairs))
