# SPDX-License-Identifier: GPL-3.0-or-later
"""Each public header opens with a use of it, and that compiles.

Usage: examples.py ROOT COMPILER

The use stands in the comment at the header's top, five blanks in, and includes the header itself.
"""

import os
import re
import subprocess
import sys
import tempfile

import project

PUBLIC = ("core/include/cautery/", "core/types/cautery/", "protocol/include/cautery/",
          "clients/include/cautery/", "server/embed/include/cautery/")
INCLUDES = ("core/include", "core/types", "protocol/include", "clients/include", "server/embed/include")
FLAGS = ("-std=gnu17", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion",
         "-Werror", "-Wno-unused-function")
LINE = re.compile(r"//(?:     (.*))?$")


def example_of(text):
    """The code in the comment before `#pragma once`, from its first #include on, or ""."""
    lines = []
    for line in text.split("#pragma once")[0].splitlines():
        match = LINE.match(line)
        if lines and not match:
            break
        if match and (lines or (match.group(1) or "").startswith("#include")):
            lines.append(match.group(1) or "")
    return "\n".join(lines).strip()


def compile_errors(root, code, compiler):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "example.c")
        with open(path, "w", encoding="utf-8") as file:
            file.write(code + "\n")
        includes = [f"-I{os.path.join(root, name)}" for name in INCLUDES]
        done = subprocess.run([compiler, *FLAGS, *includes, path], capture_output=True, text=True)
        return done.stderr if done.returncode else ""


def violations(root, files, compiler):
    found = []
    for name in files:
        if not name.startswith(PUBLIC) or not name.endswith(".h"):
            continue
        code = example_of(project.read_text(root, name) or "")
        if f'#include "cautery/{os.path.basename(name)}"' not in code:
            found.append(f"{name}: does not open with a use of it")
            continue
        errors = compile_errors(root, code, compiler)
        if errors:
            found.append(f"{name}: its use does not compile: {errors}")
    return found


if __name__ == "__main__":
    every = project.all_files(sys.argv[1])
    project.finish(violations(sys.argv[1], every, sys.argv[2]),
                   sum(name.startswith(PUBLIC) for name in every))
