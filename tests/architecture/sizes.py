# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole subjects in one file: few small files, none that is too long, no struct with too many members.

Usage: sizes.py ROOT

Of the C files (.c, .h) of the rooms at most SMALL_SHARE have fewer than SMALL lines, no C file has more than LONG, and
no struct of SPLIT has more than MEMBERS members: a reader who follows one thought otherwise opens ten files, and a
struct with more members has more than one owner.
"""

import re
import sys

import project

SMALL = 80  # lines
SMALL_SHARE = 0.25
LONG = 600  # lines
MEMBERS = 30
ROOMS = ("core/", "protocol/", "server/", "clients/")
SPLIT = ("server/", "core/session/", "core/solve/", "core/collide/")

# Too long when this check was written. Both are doubles or oracles of one concept; a list may only become shorter.
LONG_STILL = {"tests/server/double/fake_session.c": 638, "tests/server/session/oracle.c": 669}

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
STRUCT = re.compile(r"\bstruct\s*(\w*)\s*\{")


def members_of(body):
    """How many declarators a struct's body has; a struct or union inside counts as one."""
    count = depth = 0
    for sign in body:
        if sign in "{([":
            depth += 1
        elif sign in "})]":
            depth -= 1
        elif depth == 0 and sign in ",;":
            count += 1
    return count


def structs(text):
    """(name, number of members) of each struct in C text."""
    text = COMMENT.sub("", text)
    for match in STRUCT.finditer(text):
        end, depth = match.end(), 1
        while depth and end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        yield match.group(1) or "without a name", members_of(text[match.end():end - 1])


def violations(texts):
    """texts: dict of path to text, of C files."""
    found = []
    lines = {name: text.count("\n") for name, text in texts.items()}
    for name, count in sorted(lines.items()):
        if count > LONG_STILL.get(name, LONG):
            found.append(f"{name}: {count} lines, more than {LONG_STILL.get(name, LONG)}")
    found += [f"{name}: has {lines.get(name, 0)} lines, so LONG_STILL need not name it"
              for name in LONG_STILL if name in lines and lines[name] <= LONG]
    in_rooms = [count for name, count in lines.items() if name.startswith(ROOMS)]
    small = sum(count < SMALL for count in in_rooms)
    if small > SMALL_SHARE * len(in_rooms):
        found.append(f"{small} of {len(in_rooms)} C files have fewer than {SMALL} lines, more than {SMALL_SHARE:.0%}")
    for name, text in sorted(texts.items()):
        if name.startswith(SPLIT):
            found += [f"{name}: struct {struct} has {count} members, more than {MEMBERS}"
                      for struct, count in structs(text) if count > MEMBERS]
    return found


if __name__ == "__main__":
    files = [name for name in project.all_files(sys.argv[1]) if name.endswith((".c", ".h"))]
    read = {name: project.read_text(sys.argv[1], name) for name in files}
    project.finish(violations({name: text for name, text in read.items() if text is not None}), len(read))
