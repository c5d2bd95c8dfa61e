# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: whole sessions at rest against finite elements, by the test that holds them."""

import re

from sim import printed

LINE = re.compile(r"^(\w+)\s+displacement (\S+), force (\S+) of the same mesh's; "
                  r"mesh against a converged one (\S+) %", re.MULTILINE)
# What the test allows (tests/core/session/equilibrium_test.c); contact may differ by a vertex at its rim.
ALLOWED, ALLOWED_CONTACT = 1e-3, 1e-2
WHAT = {"block": "pulled block", "cantilever": "cantilever under its weight", "twist": "twisted beam",
        "indentation": "indentation by a sphere"}


def run(sim, _folder, _quick):
    found = [(name, float(moved), float(pushed), float(mesh) / 100)
             for name, moved, pushed, mesh in LINE.findall(printed(sim, "test_core_session_equilibrium"))]
    if {name.split("_")[0] for name, *_ in found} != set(WHAT):
        raise ValueError("the test of equilibria does not print all of its cases")
    figures = {}
    for name, moved, pushed, _ in found:
        figures |= {f"elements.{name}.displacement": moved, f"elements.{name}.force": pushed}
    return figures, found


def page(found):
    rows = [f"| {WHAT[name.split('_')[0]]} | `{name}` | {moved:.0e} | {pushed:.0e} | {mesh:+.1%} |"
            for name, moved, pushed, mesh in sorted(found, key=lambda row: list(WHAT).index(row[0].split("_")[0]))]
    return f"""## Finite elements

    build/tests/test_core_session_equilibrium

Sessions are stepped in double precision until the tissue is at rest. The table compares them with the static equilibria
that DOLFINx computes on the same mesh of linear tetrahedra with the same energy
([tests/reference](../reference/README.md)). "Displacement off" is the largest difference of a displacement, relative to the largest displacement. "Force off"
is the largest relative difference of the force of the supports and the sphere. The test allows {ALLOWED:g} for both,
and {ALLOWED_CONTACT:g} with contact. The last column is not an error of a solver. The last column is the difference
between this coarse mesh and a converged mesh (force of the pull, sinking of the tip, moment of the twist, force on the
sphere). This difference is large because linear tetrahedra lock.

| what | case | displacement off | force off | this mesh against a converged one |
|---|---|---:|---:|---:|
{chr(10).join(rows)}
"""
