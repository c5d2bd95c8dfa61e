# SPDX-License-Identifier: GPL-3.0-or-later
"""clang-tidy over each source of a folder, once. Usage: tidy.py ROOT FOLDER BUILD [OPTION OF CLANG-TIDY...]

BUILD/compile_commands.json has one entry for every object: a source of which several are made (the
kernels, once for each instruction set) would be looked at several times. What is left out here is
the same text with other options of the compiler.
"""

import concurrent.futures
import json
import os
import shutil
import subprocess
import sys
import tempfile

import project


def one_entry_each(root, folder, build):
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        entries = json.load(file)
    inside = os.path.join(os.path.abspath(root), folder, "")
    return {entry["file"]: entry for entry in entries if entry["file"].startswith(inside)}


def violation(database, name, options):
    answer = subprocess.run(["clang-tidy", "-quiet", "-p", database, *options, name], capture_output=True,
                            text=True, check=False)
    return (answer.stdout.strip() or answer.stderr.strip()) if answer.returncode else None


def violations(database, files, options):
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as readers:
        found = readers.map(lambda name: violation(database, name, options), files)
        return [each for each in found if each]


def main(root, folder, build, *options):
    if not shutil.which("clang-tidy"):
        project.skip("clang-tidy is not installed")
    entries = one_entry_each(root, folder, build)
    with tempfile.TemporaryDirectory() as database:
        with open(os.path.join(database, "compile_commands.json"), "w", encoding="utf-8") as file:
            json.dump(list(entries.values()), file)
        project.finish(violations(database, sorted(entries), options), len(entries))


if __name__ == "__main__":
    main(*sys.argv[1:])
