#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the paper's figures and tables from the shipped scenes, and writes this folder's README.md.

Usage: tests/paper/run.py [--programs build/bin]          all of it, and the page with its pictures
       tests/paper/run.py --quick [--programs build/bin]  a small form of each, against expected.json;
                                                          writes nothing, fails where a figure is off
       tests/paper/run.py --only NAME...                  these parts alone; writes their pictures only
"""

import argparse
import json
import os
import platform
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import costs  # noqa: E402
import dissection  # noqa: E402
import ignition  # noqa: E402
import patterns  # noqa: E402
import remeshing  # noqa: E402
import shrinkage  # noqa: E402
import strain_limits  # noqa: E402
import validation  # noqa: E402
from sim import FOLDER, ROOT, Sim  # noqa: E402

PARTS = {"strain_limits": strain_limits, "patterns": patterns, "shrinkage": shrinkage,
         "dissection": dissection, "ignition": ignition, "remeshing": remeshing, "costs": costs,
         "validation": validation}

HEAD = """# The paper, reproduced

What *Energized Soft Tissue Dissection in Surgery Simulation* shows and a simulation can make, made here: their figures
and numbers beside ours, every parameter, and in plain words where ours differs. This page is written by

    tests/paper/run.py

from the shipped scenes ([deploy/scenes](../../deploy/scenes/README.md)) through `cautery-sim`. `tests/paper/run.py
--quick` is the same code in a small form; the test `paper_quick` holds its figures to `expected.json`, each within the
tolerance that stands there. Section and equation numbers are the paper's.
"""


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        lines = dict(line.split(":", 1) for line in file if ":" in line)
    fields = {key.strip(): value.strip() for key, value in lines.items()}
    return (f"{fields.get('model name', platform.machine())}, family {fields.get('cpu family', '?')} model "
            f"{fields.get('model', '?')}")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", default=os.path.join(ROOT, "build", "bin"), help="folder of cautery-sim")
    parser.add_argument("--quick", action="store_true", help="small, against expected.json")
    parser.add_argument("--only", nargs="+", choices=sorted(PARTS), help="these parts alone")
    return parser.parse_args()


def run_parts(sim, names, quick):
    """({figure: value}, {part: section of the page})"""
    figures, sections = {}, {}
    for name in names:
        print(f"{name} ...", file=sys.stderr, flush=True)
        start = time.monotonic()
        found, details = PARTS[name].run(sim, FOLDER, quick)
        figures |= found
        sections[name] = PARTS[name].page(details)
        print(f"{name}: {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
    return figures, sections


def compare(figures, expected):
    """Complaints about figures that are off, missing, or that nobody expects."""
    complaints = [f"{name} = {figures[name]:.6g}, which expected.json does not have"
                  for name in sorted(figures.keys() - expected.keys())]
    for name, (value, tolerance) in expected.items():
        if name not in figures:
            complaints.append(f"{name}: not measured")
        elif not abs(figures[name] - value) <= tolerance:
            complaints.append(f"{name} = {figures[name]:.6g}, expected {value:g} within {tolerance:g}")
    return complaints


def check(figures, names):
    with open(os.path.join(FOLDER, "expected.json"), encoding="utf-8") as file:
        expected = json.load(file)
    of_parts = {name: pair for part in names for name, pair in expected[part].items()}
    complaints = compare(figures, of_parts)
    print("\n".join(complaints) or f"{len(figures)} figures as expected")
    return 1 if complaints else 0


def main():
    given = arguments()
    names = given.only or list(PARTS)
    start = time.monotonic()
    figures, sections = run_parts(Sim(os.path.join(given.programs, "cautery-sim")), names, given.quick)
    if given.quick:
        return check(figures, names)
    if given.only:
        print("\n".join(sections.values()))
        return 0
    last = (f"Made whole in {(time.monotonic() - start) / 60:.0f} minutes, {time.strftime('%Y-%m-%d')}, on one core of: "
            f"{processor()}.\n")
    with open(os.path.join(FOLDER, "README.md"), "w", encoding="utf-8") as file:
        file.write("\n".join([HEAD, last, *sections.values()]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
