# SPDX-License-Identifier: GPL-3.0-or-later
"""Who may include what. Usage: includes.py ROOT

core, protocol and clients see their own headers and the shared types; clients see protocol's public
headers too. A library's header is included in the one place that owns the library.
"""

import os
import posixpath
import re
import sys

import project

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)

# The door between core and protocol stays small: plain data, and what follows from it alone.
SHARED_TYPES = "core/types/"
SHARED_TYPES_MOST_FILES = 8
FAILED_ASSERTION = SHARED_TYPES + "assert.c"  # the one source among the headers

# Folders (relative to the root) in which an include of a room's file may be found.
DOORS = {
    "core": ("core", "core/include", "core/types"),
    "protocol": ("protocol", "protocol/include", "core/types"),
    "clients": ("clients", "clients/include", "protocol/include", "core/types"),
}
ROOMS = ("core", "protocol", "server", "clients", "tests")

# A library's headers, and the path prefixes of the files that may include them.
LIBRARIES = (
    (r"(suitesparse/)?(cholmod|SuiteSparse_config|amd|camd|colamd|metis)\w*\.h", ("core/solve/factor.c",)),
    # The command line keeps a file of its own in JSON, and changes members of what the tables wrote.
    (r"(cjson/)?cJSON\w*\.h", ("protocol/", "clients/cautery/")),
    (r"meshoptimizer\.h", ("protocol/",)),
    (r"libwebsockets\.h|lws.*\.h", ("server/", "clients/")),
    (r"(dds|ddsc)/.*|dds\.h", ("server/", "clients/")),
    (r"sqlite3\.h", ("server/",)),
    (r"zlib\.h", ("core/mesh/vtu_data.c", "core/solid/unpack.c", "server/")),
    (r"curl/.*", ("server/lease/etcd.c",)),
    (r"systemd/.*", ("server/",)),
    (r"openssl/.*", ("protocol/wire/sha256.c", "server/")),
    (r"(sys/socket|sys/epoll|sys/un|poll|netdb|netinet/.*|arpa/.*)\.?h?", ("server/", "clients/")),
    (r"(time|sys/time)\.h", ("server/", "clients/")),
    (r"threads\.h", ("core/base/", "server/", "clients/")),
)
# In tests any library may be used: they look at all sides.
FREE = ("tests/", "deploy/")


def library_violation(name, header):
    for pattern, allowed in LIBRARIES:
        if re.fullmatch(pattern, header) and not name.startswith(allowed + FREE):
            return f"{name}: includes <{header}>, which belongs to {', '.join(allowed)}"
    return None


def door_violation(name, header, headers):
    """`headers` holds every header of the project. Unknown names are system or generated ones."""
    room = name.split("/")[0]
    if room not in DOORS:
        return None
    beside = posixpath.normpath(posixpath.join(posixpath.dirname(name), header))
    if beside in headers and beside.split("/")[0] == room:
        return None
    if any(posixpath.join(folder, header) in headers for folder in DOORS[room]):
        return None
    places = [""] + [p for other in ROOMS for p in (other, other + "/include", other + "/types")]
    for place in places:
        if posixpath.join(place, header) in headers:
            return f"{name}: includes \"{header}\" of {place or 'another room'}: no door from {room}"
    if beside in headers:
        return f"{name}: includes \"{header}\", which leaves {room}"
    return None


def shared_type_violations(root, files):
    shared = [name for name in files if name.startswith(SHARED_TYPES) and not name.endswith(".txt")]
    found = [f"{name}: core/types holds headers only" for name in shared
             if not name.endswith(".h") and name != FAILED_ASSERTION]
    headers = [name for name in shared if name != FAILED_ASSERTION]
    if len(headers) > SHARED_TYPES_MOST_FILES:
        found.append(f"core/types: {len(headers)} files, at most {SHARED_TYPES_MOST_FILES} are shared")
    for name in shared:
        for quote, header in INCLUDE.findall(project.read_text(root, name) or ""):
            if (quote == '"' or "/" in header) and SHARED_TYPES + header not in files:
                found.append(f"{name}: includes \"{header}\": shared types know each other only")
    return found


def violations(root, files):
    headers = {name for name in files if name.endswith(".h")}
    found = shared_type_violations(root, files)
    for name in files:
        if os.path.splitext(name)[1] not in (".c", ".h"):
            continue
        for _, header in INCLUDE.findall(project.read_text(root, name) or ""):
            found += [v for v in (library_violation(name, header),
                                  door_violation(name, header, headers)) if v]
    return found


if __name__ == "__main__":
    every = project.all_files(sys.argv[1])
    project.finish(violations(sys.argv[1], every), sum(n.endswith((".c", ".h")) for n in every))
