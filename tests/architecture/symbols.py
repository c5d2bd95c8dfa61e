# SPDX-License-Identifier: GPL-3.0-or-later
"""Which symbols the compiled objects of each room may need. Usage: symbols.py OBJECT_LIST

OBJECT_LIST has one line per object file: room, '|', path. An object's source is read off its path
(.../<target>.dir/mesh/edge_table.c.o of core is core/mesh/edge_table.c).
"""

import os
import re
import subprocess
import sys

import project

# A library's symbols, and the path prefixes of the sources that may need them.
LIBRARIES = (
    ("SuiteSparse", r"(cholmod|SuiteSparse|amd|camd|colamd|METIS|openblas)_\w+", ("core/solve/factor.c",)),
    ("cJSON", r"cJSON_\w+", ("protocol/",)),
    ("meshoptimizer", r"meshopt_\w+", ("protocol/",)),
    ("libwebsockets", r"_?lws\w*", ("server/", "clients/")),
    ("Cyclone DDS", r"dds_\w+", ("server/", "clients/")),
    ("SQLite", r"sqlite3_\w+", ("server/",)),
    ("systemd", r"sd_\w+", ("server/",)),
    ("OpenSSL", r"(SSL|EVP|BIO|ERR|X509|RAND|PEM)_\w+|SHA\d+\w*", ("server/", "clients/")),
)

# What core and protocol must not call, and the sources that still may.
SYSTEM = (
    ("sockets", r"socket|socketpair|connect|bind|listen|accept4?|send(to|msg|mmsg)?|recv(from|msg|mmsg)?"
                r"|p?poll|p?select|epoll_\w+|getaddrinfo", ()),
    ("clocks", r"time|clock|clock_gettime|gettimeofday|timespec_get|(clock_)?nanosleep|u?sleep"
               r"|timerfd_\w+|(local|gm)time(_r)?", ()),
    ("the console", r"v?printf|puts|putchar|perror|stdout|stderr|getchar|scanf|stdin", ()),
    ("ending the process", r"_?exit|_Exit|quick_exit|abort|atexit|signal|sigaction|raise|kill", ()),
    ("other programs", r"system|popen|fork|vfork|exec[vl]\w*|posix_spawnp?|dlopen", ()),
    ("files", r"fopen|freopen|fdopen|open|openat|creat|tmpfile|mkstemp", ("core/mesh/",)),
    ("threads", r"pthread_create|thrd_create|clone3?", ("core/base/",)),
    ("process-wide random numbers", r"s?rand|s?random|[dels]rand48|getrandom", ()),
    ("the environment", r"(secure_)?getenv|setenv|putenv|setlocale", ()),
)
CLOSED_ROOMS = ("core", "protocol")

# Whose cau_ functions a room may call.
DOORS = {"core": ("core",), "protocol": ("protocol",), "clients": ("clients", "protocol")}


def plain_name(symbol):
    """Without symbol version, fortification and large-file spelling: __printf_chk@GLIBC -> printf."""
    symbol = symbol.split("@")[0]
    fortified = re.fullmatch(r"__(\w+?)_chk", symbol)
    symbol = fortified.group(1) if fortified else symbol
    return re.sub(r"^(fopen|open|openat|creat|freopen|tmpfile|mkstemp)64$", r"\1", symbol)


def source_of(room, path):
    source = re.sub(r"\.o$", "", path.split(".dir/", 1)[-1])
    return room + "/" + os.path.normpath(source)


def read_symbols(path):
    """(undefined, defined global) symbol names of one object file."""
    listing = subprocess.run(["nm", "--format=posix", "--extern-only", path],
                             capture_output=True, check=True, text=True).stdout
    undefined, defined = set(), set()
    for line in listing.splitlines():
        name, kind = line.split()[:2]
        (undefined if kind in "Uwv" else defined).add(plain_name(name))
    return undefined, defined


def symbol_violation(room, source, symbol):
    for library, pattern, allowed in LIBRARIES:
        if re.fullmatch(pattern, symbol) and not source.startswith(allowed):
            return f"{source}: needs {symbol}: {library} belongs to {', '.join(allowed)}"
    if room in CLOSED_ROOMS:
        for what, pattern, allowed in SYSTEM:
            if re.fullmatch(pattern, symbol) and not (allowed and source.startswith(allowed)):
                return f"{source}: needs {symbol}: {room} knows nothing of {what}"
    return None


def violations(objects):
    """`objects`: (room, path) pairs."""
    found, defined_by, needed = [], {}, []
    for room, path in objects:
        source = source_of(room, path)
        undefined, defined = read_symbols(path)
        for symbol in defined:
            defined_by.setdefault(symbol, room)
            if room in CLOSED_ROOMS and not symbol.startswith(("cau_", "__", "_cau_")):
                found.append(f"{source}: exports {symbol}: only cau_ names leave a file of {room}")
        for symbol in sorted(undefined):
            needed.append((room, source, symbol))
    for room, source, symbol in needed:
        if symbol in defined_by:
            if room in DOORS and defined_by[symbol] not in DOORS[room]:
                found.append(f"{source}: needs {symbol} of {defined_by[symbol]}: no door from {room}")
            continue
        violation = symbol_violation(room, source, symbol)
        if violation:
            found.append(violation)
    return found


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as listing:
        pairs = [tuple(line.strip().split("|", 1)) for line in listing if "|" in line]
    missing = [f"{path}: not built" for _, path in pairs if not os.path.exists(path)]
    project.finish(missing or violations(pairs), len(pairs))
