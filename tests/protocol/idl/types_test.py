# SPDX-License-Identifier: GPL-3.0-or-later
"""The DDS types are those of the protocol's version.

They are @final: with a member more or less, or of another type, programs that were built before take
no sample any more. So such a change is a new version: raise CAU_FRAME_VERSION, give the new types
names of their own, and keep what this program prints with --print as version_N.txt. A type that no
topic had before is no such change: it is added to the file of the version.

Usage: types_test.py ROOT [--print]
"""

import difflib
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def types_of(idl):
    """The declarations, one line each, without comments."""
    text = re.sub(r"//[^\n]*", "", idl)
    text = re.sub(r"\s+", " ", text)
    text = re.sub(r"([;{},]) ?", r"\1\n", text)
    return [line.strip() for line in text.splitlines() if line.strip()]


def read(root, *path):
    with open(os.path.join(root, *path), encoding="utf-8") as file:
        return file.read()


def main():
    root = sys.argv[1]
    now = types_of(read(root, "protocol", "idl", "cautery.idl"))
    if "--print" in sys.argv[2:]:
        print(*now, sep="\n")
        return 0
    version = re.search(r"CAU_FRAME_VERSION = (\d+)", read(root, "protocol/include/cautery/frame_codec.h")).group(1)
    name = f"version_{version}.txt"
    kept = read(HERE, name).splitlines()
    if now == kept:
        print(f"{sum('struct' in line for line in now)} types are those of {name}")
        return 0
    print(*difflib.unified_diff(kept, now, name, "protocol/idl/cautery.idl", lineterm=""), sep="\n")
    print(__doc__)
    return 1


sys.exit(main())
