# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows a page's list of steps to the letter, on a copy of the sources.

Usage: follow.py [--edits-only] ROOT COPY PAGE SECTION MOST TESTS [PAGE SECTION MOST TESTS...]

SECTION is a heading of PAGE. Under it each block of code has a sentence before it that ends with a
colon and says what to do with it:

    Make `PATH`:                                the block is a new file
    In `PATH`, above the line `LINE`:           the block goes in there; so do the two below
    In `PATH`, below the line `LINE`:
    In `PATH`, in place of the line `LINE`:
    Run:                                        the block is a shell script, run at the top of the copy

LINE must be in the file once, whatever stands before and after it on the line as white space. A
block that no such sentence precedes, and a sentence without a block, are errors: nothing in the
list may be left to the reader. Every one of TESTS, with commas between them, must have been run by
ctest and passed by what the list runs. At the end the files that a list changed are counted, generated
and test files left out: at most MOST.

Several lists are followed together, as by somebody who adds several things at once: the edits of all,
then what each runs, which every list has at its end. So what they all touch is built once.

With --edits-only nothing is run: that the list still fits the sources is seen in a moment.

COPY is a folder that this program owns: it is made to hold what ROOT holds, but for what builds
made there, which stays and makes the next run quicker.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "architecture"))
import project  # noqa: E402

MAKE = re.compile(r"Make `([^`]+)`:$")
EDIT = re.compile(r"[Ii]n `([^`]+)`, (above|below|in place of) the line `([^`]+)`:$")
RUN = re.compile(r"Run:$")
DIRECTIVE = re.compile(r"\b((?:Make|[Ii]n) `[^`]+`(?:, (?:above|below|in place of) the line `[^`]+`)?:|Run:)$")

# What `ninja messages` writes.
GENERATED = {"protocol/asyncapi.json", "protocol/messages.md", "protocol/examples.md", "protocol/idl/channels.idl",
             "clients/web/src/wire/messages.gen.ts", "clients/python/cautery/messages.py"}
SHARED_PACKAGES = "clients/web/node_modules"  # what `npm ci` made there serves the copy too


class Wrong(Exception):
    """The page and the sources do not fit."""


def section_of(page, heading):
    found, level = [], 0
    fenced = False
    for line in page.splitlines():
        fenced ^= line.lstrip().startswith("```")
        mark = None if fenced else re.match(r"(#+) (.*)$", line)
        if mark and level and len(mark.group(1)) <= level:
            break
        if level:
            found.append(line)
        elif mark and mark.group(2) == heading:
            level = len(mark.group(1))
    if not level:
        raise Wrong(f"there is no section `{heading}`")
    return found


def steps_of(lines):
    """(directive, block) of each step, in order."""
    found, directive, block, indent = [], None, None, ""
    for line in lines:
        if line.lstrip().startswith("```"):
            if block is None:
                if directive is None:
                    raise Wrong(f"a block without a sentence that says what to do with it: {line}")
                block, indent = [], line[:len(line) - len(line.lstrip())]
            else:
                found.append((directive, "".join(text + "\n" for text in block)))
                directive = block = None
        elif block is not None:
            block.append(line[len(indent):] if line.startswith(indent) else line.lstrip())
        elif line.strip():
            if directive:
                raise Wrong(f"no block follows: {directive}")
            said = DIRECTIVE.search(line.strip())
            directive = said.group(1) if said else None
    if directive or block is not None:
        raise Wrong("the last step has no end")
    if not found:
        raise Wrong("the section has no steps")
    return found


def make(copy, path, text):
    whole = os.path.join(copy, path)
    if os.path.exists(whole):
        raise Wrong(f"{path} is there already")
    os.makedirs(os.path.dirname(whole), exist_ok=True)
    with open(whole, "w", encoding="utf-8") as file:
        file.write(text)


def edit(copy, path, how, anchor, text):
    whole = os.path.join(copy, path)
    with open(whole, encoding="utf-8") as file:
        lines = file.read().splitlines(keepends=True)
    places = [i for i, line in enumerate(lines) if line.strip() == anchor]
    if len(places) != 1:
        raise Wrong(f"{path}: the line `{anchor}` is there {len(places)} times")
    first = places[0] + (how == "below")
    lines[first:first + (how == "in place of")] = [text]
    with open(whole, "w", encoding="utf-8") as file:
        file.write("".join(lines))


def run(copy, script):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("CAUTERY")}
    said = []
    with subprocess.Popen(["sh", "-e", "-c", script], cwd=copy, env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as running:
        for line in running.stdout:
            print(line, end="", flush=True)
            said.append(line)
    if running.returncode:
        raise Wrong(f"exit code {running.returncode} of:\n{script}")
    return "".join(said)


def edit_all(copy, steps):
    """Makes and changes what the list says; returns the files."""
    edited = set()
    for directive, block in steps:
        print(f"==== {directive}", flush=True)
        making, editing = MAKE.match(directive), EDIT.match(directive)
        if making:
            make(copy, making.group(1), block)
        elif editing:
            edit(copy, editing.group(1), editing.group(2), editing.group(3), block)
        elif RUN.match(directive):
            continue
        else:
            raise Wrong(f"not a step that can be followed: {directive}")
        edited.add((making or editing).group(1))
    return edited


def run_all(copy, steps):
    """Runs what the list says; returns what was said."""
    runs = [bool(RUN.match(directive)) for directive, _ in steps]
    if runs != sorted(runs):
        raise Wrong("something is to be done after what is to be run")
    return "".join(run(copy, block) for directive, block in steps if RUN.match(directive))


def files_of_copy(copy):
    """What is in the copy but for what builds made; git does not know the copy."""
    found = []
    for folder, folders, names in os.walk(copy):
        top = folder == copy
        folders[:] = [f for f in folders if f != "node_modules" and not (top and f.startswith("build"))]
        found += [os.path.relpath(os.path.join(folder, name), copy) for name in names]
    return found


def content(root, name):
    with open(os.path.join(root, name), "rb") as file:
        return file.read()


def bring_up_to_date(root, copy):
    """Makes the copy's files those of root. What is the same stays as it is, time stamps and all."""
    names = project.all_files(root)
    for name in names:
        to = os.path.join(copy, name)
        if not os.path.isfile(to) or content(root, name) != content(copy, name):
            os.makedirs(os.path.dirname(to), exist_ok=True)
            shutil.copy(os.path.join(root, name), to)
    for name in set(files_of_copy(copy)) - set(names):
        os.remove(os.path.join(copy, name))
    packages, here = (os.path.join(of, SHARED_PACKAGES) for of in (root, copy))
    if os.path.isdir(packages) and not os.path.lexists(here):
        os.symlink(packages, here)


def fingerprints(copy):
    return {name: hashlib.sha256(content(copy, name)).hexdigest() for name in files_of_copy(copy)}


def changed_files(copy, before):
    """New, and other than their fingerprint `before`."""
    return sorted(name for name, now in fingerprints(copy).items() if before.get(name) != now)


class List:
    """One list of a page, with what it may change at most and the tests that it adds."""

    def __init__(self, root, page, section, most, tests):
        with open(os.path.join(root, page), encoding="utf-8") as file:
            self.steps = steps_of(section_of(file.read(), section))
        self.page, self.section, self.most, self.tests = page, section, int(most), tests.split(",")
        self.changed = set()

    def edit(self, copy):
        self.changed |= edit_all(copy, self.steps)

    def run(self, copy):
        """Returns what running it changed besides."""
        before = fingerprints(copy)
        said = run_all(copy, self.steps)
        for test in self.tests:
            if not re.search(rf" {re.escape(test)} \.+ +Passed ", said):
                raise Wrong(f"{self.section}: the test {test} was not run, or did not pass")
        return set(changed_files(copy, before))

    def count(self):
        counted = sorted(name for name in self.changed if name not in GENERATED and not name.startswith("tests/"))
        print(f"{self.section}: {len(counted)} files, generated and test files not counted:", *counted, sep="\n  ")
        if len(counted) > self.most:
            raise Wrong(f"{self.section}: more than {self.most} files")


def run_lists(copy, lists):
    """What one list's commands wrote, others of its page would have: it counts for each of them."""
    for each in lists:
        wrote = each.run(copy)
        for other in lists:
            if other.page == each.page:
                other.changed |= wrote


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--edits-only"]
    edits_only = len(arguments) < len(sys.argv) - 1
    root, copy = arguments[:2]
    os.makedirs(copy, exist_ok=True)
    bring_up_to_date(root, copy)
    lists = [List(root, *arguments[first:first + 4]) for first in range(2, len(arguments), 4)]
    for each in lists:
        each.edit(copy)
    if not edits_only:
        run_lists(copy, lists)
    for each in lists:
        each.count()


if __name__ == "__main__":
    try:
        main()
    except Wrong as wrong:
        print(wrong)
        sys.exit(1)
