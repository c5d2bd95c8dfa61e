# SPDX-License-Identifier: GPL-3.0-or-later
"""Which symbols the compiled objects of each room may need. Usage: symbols.py OBJECT_LIST

OBJECT_LIST has one line per object file: folder of its target, '|', path. An object's source is read
off its path (.../<target>.dir/mesh/edge_table.c.o of core is core/mesh/edge_table.c).
"""

import os
import re
import subprocess
import sys

import project

# A library's symbols, and the path prefixes of the sources that may need them.
LIBRARIES = (
    ("SuiteSparse", r"(cholmod|SuiteSparse|amd|camd|colamd|METIS|openblas)_\w+", ("core/solve/factor.c",)),
    ("cJSON", r"cJSON_\w+", ("protocol/", "clients/cautery/")),
    ("meshoptimizer", r"meshopt_\w+", ("protocol/",)),
    ("libwebsockets", r"_?lws\w*", ("server/", "clients/")),
    ("Cyclone DDS", r"dds_\w+", ("server/", "clients/")),
    ("SQLite", r"sqlite3_\w+", ("server/",)),
    ("zlib", r"(un)?compress2?|(in|de)flate\w*", ("core/mesh/vtu_data.c", "core/solid/unpack.c", "server/")),
    ("libcurl", r"curl_\w+", ("server/lease/etcd.c",)),
    ("systemd", r"sd_\w+", ("server/",)),
    ("OpenSSL", r"(SSL|EVP|BIO|ERR|X509|RAND|PEM)_\w+|SHA\d+\w*", ("protocol/wire/sha256.c", "server/")),
)

# What a failed assertion calls, wherever it stands; Release builds have none. Safety rules stand in every build.
ASSERTIONS = "core/types/assert.c"
FAILED = "cau_assert_failed"
RULES = ("cau_rule_broken", "cau_rule_enter", "cau_rule_leave")

# What core and protocol must not call, and the sources that still may. pages.c asks the system which
# of its own pages were touched, and Linux answers in a file.
SYSTEM = (
    ("sockets", r"socket|socketpair|connect|bind|listen|accept4?|send(to|msg|mmsg)?|recv(from|msg|mmsg)?"
                r"|p?poll|p?select|epoll_\w+|getaddrinfo", ()),
    ("clocks", r"time|clock|clock_gettime|gettimeofday|timespec_get|(clock_)?nanosleep|u?sleep"
               r"|timerfd_\w+|(local|gm)time(_r)?", ()),
    ("the console", r"v?printf|puts|putchar|perror|stdout|stderr|getchar|scanf|stdin", (ASSERTIONS,)),
    ("ending the process", r"_?exit|_Exit|quick_exit|abort|atexit|signal|sigaction|raise|kill", (ASSERTIONS,)),
    ("other programs", r"system|popen|fork|vfork|exec[vl]\w*|posix_spawnp?|dlopen", ()),
    ("files", r"fopen|freopen|fdopen|open|openat|creat|tmpfile|mkstemp", ("core/mesh/", "core/base/pages.c")),
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


def source_of(folder, path):
    source = re.sub(r"\.o$", "", path.split(".dir/", 1)[-1])
    return folder + "/" + os.path.normpath(source)


def read_list(path):
    """(folder, path) of each object on the list, and a sentence for each that is not there."""
    with open(path, encoding="utf-8") as listing:
        pairs = [tuple(line.strip().split("|", 1)) for line in listing if "|" in line]
    return pairs, [f"{name}: not built" for _, name in pairs if not os.path.exists(name)]


def read_symbols(paths):
    """{path: (undefined, defined global) symbol names} of object files."""
    found = {path: (set(), set()) for path in paths}
    if not found:
        return found  # else nm would look for a.out
    listing = subprocess.run(["nm", "--format=posix", "--extern-only", "--print-file-name", *found],
                             capture_output=True, check=True, text=True).stdout
    for line in listing.splitlines():
        path, rest = line.split(": ", 1)
        name, kind = rest.split()[:2]
        found[path][0 if kind in "Uwv" else 1].add(plain_name(name))
    return found


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
    """`objects`: (folder, path) pairs."""
    found, defined_by, needed = [], {}, []
    symbols_of = read_symbols([path for _, path in objects])
    for folder, path in objects:
        source = source_of(folder, path)
        room = source.split("/")[0]
        undefined, defined = symbols_of[path]
        for symbol in defined:
            defined_by.setdefault(symbol, room)
            if room in CLOSED_ROOMS and not symbol.startswith(("cau_", "__", "_cau_")):
                found.append(f"{source}: exports {symbol}: only cau_ names leave a file of {room}")
        for symbol in sorted(undefined):
            needed.append((room, source, symbol))
    for room, source, symbol in needed:
        if symbol in defined_by:
            if room in DOORS and symbol not in (FAILED, *RULES) and defined_by[symbol] not in DOORS[room]:
                found.append(f"{source}: needs {symbol} of {defined_by[symbol]}: no door from {room}")
            continue
        violation = symbol_violation(room, source, symbol)
        if violation:
            found.append(violation)
    return found


if __name__ == "__main__":
    pairs, missing = read_list(sys.argv[1])
    project.finish(missing or violations(pairs), len(pairs))
