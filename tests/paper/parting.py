# SPDX-License-Identifier: GPL-3.0-or-later
"""Section 6.1: the paper's rule of parting beside the one that does not depend on the mesh, on the paper's cuts."""

import dissection
from drawing import Montage
from sim import at_once

RULES = ("edges", "elements")


def make_by(rule, make):
    def made(sim):
        return make(sim) | {"parting": rule}
    return made


def run(sim, folder, quick):
    cases = [(f"{name}, by {rule}", make_by(rule, make), way, layer)
             for name, make, way, layer in (dissection.CASES[:1] if quick else dissection.CASES) for rule in RULES]
    runs = at_once([lambda case=case: dissection.dissect(sim, *case) for case in cases])
    montage = Montage(4, 260, 205, 3500)
    for case, cut in zip(cases, runs):
        cut.draw(montage, case[0], cut.last)
    if not quick:
        montage.write(f"{folder}/parting.svg")
    found = [(case[0], cut.measures) for case, cut in zip(cases, runs)]
    return {f"parting.{name.replace(', by ', '.')}.open_mm": of["mean_mm"] for name, of in found}, found


def page(found):
    rows = [f"| {name} | {of['gone']} | {of['charred']} | {of['strands']} | {of['rough_mm']:.2f} | {of['least_mm']:.1f}, {of['mean_mm']:.1f}, "
            f"{of['most_mm']:.1f} |" for name, of in found]
    return f"""## Section 6.1: two rules of parting

A scene chooses what heat parts (`parting`). *edges* is the paper's rule: an edge gathers heat over its length (eq. 20),
and when the edge parts, its elements part too. The paper's scenes use this rule, and so do all other figures of this
page. *elements* is our rule: each triangle and tetrahedron parts by the dose at its own middle. Its ignition temperature
comes from a random field over the rest shape. `layers` and scenes from mesh files use this rule. By edges, the size of a cut depends
on the mesh: besides the tissue that heat has parted, half a cell on all sides is removed ([validation.md](validation.md),
"What a cut depends on"). The picture shows the cuts of figure 7 by both rules, when the cuts have ended:

![The cuts of figure 7 by both rules](parting.svg)

| scene, rule | gone | charred | strands across | roughness of the lips, mm | open: least, mean, most, mm |
|---|---:|---:|---:|---:|---:|
{chr(10).join(rows)}

The section on figure 7 explains the columns of the table. By elements, only the tissue that heat reaches is removed. So
the same path of the tool removes less, and bundles that withstand their dose stay as bridges. By elements, the opening of the
frayed fascia is a third of its opening by edges. The frayed fat, drawn at 4 mm/s, is hardly divided. (Bridges that hang
together beside the gap count as one strand.) In the paper's two cuts every bundle gets more heat than it withstands. In
these cuts the results of the two rules differ by the width of one cell.
"""
