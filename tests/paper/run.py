#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the paper's figures and tables and the validation of the method, and writes README.md, validation.md and energy.md
here.

Usage: tests/paper/run.py [--programs build/bin]          all of it, and all pages with their pictures
       tests/paper/run.py --quick [--programs build/bin]  a small form of each, against expected.json;
                                                          writes nothing, fails where a figure is off
       tests/paper/run.py --only NAME...                  these parts alone; writes their pictures, pages that
                                                          they are all of, and prints their sections
       tests/paper/run.py --keep FILE                     all of it, but what FILE has from a run that was
                                                          interrupted; each part is kept there when made

Wants the programs and tests of a Release build; gnuplot for plots; for the viewer's pictures Chromium and
clients/web/node_modules (npm ci there). A part that cannot be made says so on its page, and the command fails.
"""

import argparse
import json
import os
import platform
import sys
import time
import traceback

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import conservation  # noqa: E402
import contact  # noqa: E402
import costs  # noqa: E402
import cuts  # noqa: E402
import dissection  # noqa: E402
import elements  # noqa: E402
import energy  # noqa: E402
import errors  # noqa: E402
import heat  # noqa: E402
import held  # noqa: E402
import ignition  # noqa: E402
import loads  # noqa: E402
import parting  # noqa: E402
import patterns  # noqa: E402
import remeshing  # noqa: E402
import shrinkage  # noqa: E402
import strain_limits  # noqa: E402
import viewer  # noqa: E402
from sim import FOLDER, ROOT, Sim  # noqa: E402

PAPER = {"strain_limits": strain_limits, "patterns": patterns, "parting": parting, "shrinkage": shrinkage,
         "dissection": dissection, "viewer": viewer, "ignition": ignition, "remeshing": remeshing, "costs": costs}
VALIDATION = {"elements": elements, "heat": heat, "conservation": conservation, "loads": loads, "contact": contact,
              "errors": errors, "cuts": cuts}
ENERGY = {"energy": energy}
PARTS = PAPER | VALIDATION | ENERGY
NOT_QUICK = {"viewer"}  # the browser's own tests hold the viewer; what is cut in its pictures, figure 7's figures

PAPER_HEAD = """# The paper, reproduced

This page reproduces what *Energized Soft Tissue Dissection in Surgery Simulation* shows, as far as a simulation can. It
compares the paper's figures and numbers with ours, and lists every parameter and every difference. One command writes
this page, and the page [validation.md](validation.md) beside it:

    tests/paper/run.py

The command uses the shipped scenes ([deploy/scenes](../../deploy/scenes/README.md)), `cautery-sim` and the viewer.
`tests/paper/run.py --quick` runs the same code in a small form. The test `paper_quick` compares the figures of this
small form with `expected.json`, each within the tolerance that this file gives. `--only NAME` writes only the part
`NAME`. Section and equation numbers are the paper's.
"""

VALIDATION_HEAD = """# The method, validated

This page has the method's errors in cases with a known solution. It also shows which settings change the method's
results. `tests/paper/run.py` writes this page and [the paper's page](README.md). Each section names the command that
computes its numbers. The test `paper_quick` runs some cases of each section in a small form, and compares their figures
with `expected.json`.
"""

ENERGY_HEAD = """# Energy, validated

This page checks energy `tissue` ([core/bioheat](../../core/bioheat/README.md)) by its energy ledger, and shows which
settings change a cut by power. `tests/paper/run.py --only energy` writes this page. The test `paper_quick` compares
some of the page's figures with `expected.json`.
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
    parser.add_argument("--only", nargs="+", choices=list(PARTS), metavar="NAME",
                        help=f"these parts alone: {', '.join(PARTS)}")
    parser.add_argument("--keep", metavar="FILE", help="parts that are made, of this run and an earlier one")
    return parser.parse_args()


def say(text):
    print(text, file=sys.stderr, flush=True)


def make(sim, name, quick):
    """(figures, section of a page, None or why there is none)"""
    try:
        figures, details = PARTS[name].run(sim, FOLDER, quick)
        return figures, "" if quick else PARTS[name].page(details), None
    except Exception as error:  # of whatever kind: the other parts are worth having
        traceback.print_exc()
        why = f"{type(error).__name__}: {error}"
        return {}, f"## {name}\n\nCould not be made this time: {why}\n", why


def read_kept(path):
    """{part: its section and the seconds that it took}, of an interrupted run."""
    if not path or not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def write_kept(path, kept):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(kept, file, indent=1)


def run_parts(sim, names, quick, keep=None):
    """({figure: value}, {part: section of its page}, {part: why it could not be made}, seconds in all)"""
    figures, sections, failed, kept, took = {}, {}, {}, read_kept(keep), 0
    for index, name in enumerate(names):
        if name in kept:
            sections[name] = kept[name]["section"]
            took += kept[name]["seconds"]
            continue
        say(f"{index + 1} of {len(names)}: {name} ...")
        start = time.monotonic()
        found, sections[name], why = make(sim, name, quick)
        seconds = time.monotonic() - start
        took += seconds
        figures |= found
        if why:
            failed[name] = why
        elif keep:
            kept[name] = {"section": sections[name], "seconds": seconds}
            write_kept(keep, kept)
        say(f"{name}: {why or 'made'}, {seconds:.0f} s")
    return figures, sections, failed, took


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


def duration(seconds):
    return f"{seconds / 60:.0f} minutes" if seconds >= 90 else f"{seconds:.0f} seconds"


def made_line(seconds, load_before, failed):
    cores = len(os.sched_getaffinity(0))
    missing = f" except {', '.join(failed)}" if failed else ""
    return (f"A run of {duration(seconds)} made every part of this page{missing} ({time.strftime('%Y-%m-%d')}, {cores} cores of "
            f"{processor()}). The machine's load average before the run was {load_before:.1f}. If this load is not near 0, other "
            "programs ran too, so compare times only within one table.\n")


def write_pages(sections, last):
    """Each page of which all parts are there."""
    for file_name, head, parts, tail in (("README.md", PAPER_HEAD, PAPER, []),
                                         ("validation.md", VALIDATION_HEAD, VALIDATION, [held.table]),
                                         ("energy.md", ENERGY_HEAD, ENERGY, [])):
        if parts.keys() <= sections.keys():
            with open(os.path.join(FOLDER, file_name), "w", encoding="utf-8") as file:
                file.write("\n".join([head, last, *(sections[name] for name in parts), *(make() for make in tail)]))


def main():
    given = arguments()
    names = given.only or [name for name in PARTS if not (given.quick and name in NOT_QUICK)]
    load_before = os.getloadavg()[0]
    sim = Sim(os.path.join(given.programs, "cautery-sim"))
    figures, sections, failed, took = run_parts(sim, names, given.quick, given.keep)
    status = check(figures, names) if given.quick else 0
    if given.only and not given.quick:
        print("\n".join(sections.values()))
    if not given.quick:
        write_pages(sections, made_line(took, load_before, failed))
    say(f"{len(names) - len(failed)} of {len(names)} parts in {duration(took)}")
    return 1 if failed else status


if __name__ == "__main__":
    sys.exit(main())
