# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: what a cut takes by mesh, step and iterations, by both rules of parting."""

import math

import plots
from sim import at_once
from vtu import TETRAHEDRON

RULES = ("edges", "elements")
HALF_M = 0.02  # of the cut
SIZE_M, CELLS = [0.052, 0.02, 0.008], (26, 10, 4)  # the slab of `fat-neohookean`, as wide as the tool reaches; its cells
MESHES = (0.5, 1, 1.5, 2)
NEAR_M = 1e-4  # of a face of the slab
OFFSETS = 8  # ways that lie otherwise in the cells, by the golden ratio
GOLDEN = 0.618034
VARIANTS = (("1/60 s, error 1 %", {}), ("1/30 s", {"step_s": 1 / 30}), ("1/120 s", {"step_s": 1 / 120}),
            ("5 iterations", {"iterations": 5, "accuracy": 0}), ("10 iterations", {"iterations": 10, "accuracy": 0}),
            ("20 iterations", {"iterations": 20, "accuracy": 0}))


def volume(rest, cell):
    a, b, c, d = (rest.position_m[v] for v in cell)
    e = [[q - p for p, q in zip(a, corner)] for corner in (b, c, d)]
    cross = (e[1][1] * e[2][2] - e[1][2] * e[2][1], e[1][2] * e[2][0] - e[1][0] * e[2][2],
             e[1][0] * e[2][1] - e[1][1] * e[2][0])
    return abs(sum(p * q for p, q in zip(e[0], cross))) / 6


def held(from_x, to_x, up_to_z=1):
    """Vertices in a range of x, no higher than z: bottom and both short ends are pinned, as the shipped slab's are."""
    return {"kind": "box", "layer": "fat", "least_m": [from_x, -1, -1], "most_m": [to_x, 1, up_to_z + NEAR_M]}


def scene_of(sim, rule, fineness, offset, changes):
    scene = sim.scene("fat-neohookean") | changes | {"parting": rule}
    scene["meshes"][0] |= {"size_m": SIZE_M, "cells": [round(cells * fineness) for cells in CELLS]}
    scene["pins"] = [held(-1, 1, -SIZE_M[2]), held(-1, -SIZE_M[0] / 2 + NEAR_M), held(SIZE_M[0] / 2 - NEAR_M, 1)]
    cell_m = SIZE_M[0] / CELLS[0] / fineness
    x, y = cell_m * offset / OFFSETS, cell_m * math.fmod(GOLDEN * offset, 1)
    scene["tools"][0]["position_m"] = [x - HALF_M, y, 0.02]
    scene["cut"] |= {"from_m": [x - HALF_M, y, 0], "to_m": [x + HALF_M, y, 0]}
    return scene


def burnt_mm3(sim, rule, fineness, offset=0, changes=()):
    """Rest volume of the tetrahedra that a drawn cut takes."""
    scene = scene_of(sim, rule, fineness, offset, dict(changes))
    steps_per_s = round(1 / scene.get("step_s", 1 / 60))
    seconds = math.ceil(6 + 2 * HALF_M / scene["cut"]["speed_m_s"])
    run = sim.run(scene, cut=True, seconds=seconds, states_every=seconds * steps_per_s)
    whole, left = run.states[0], run.states[max(run.states)]
    alive = {cell for cell, kind in zip(left.cells, left.kind) if kind == TETRAHEDRON}
    return 1e9 * sum(volume(whole, cell) for cell, kind in zip(whole.cells, whole.kind)
                     if kind == TETRAHEDRON and cell not in alive)


def measured(sim, cases):
    """{case: volumes}; each case is (rule, fineness, offset, changes), those that take longest first."""
    order = sorted(cases, key=lambda case: -case[1])
    volumes = at_once([lambda case=case: burnt_mm3(sim, *case) for case in order])
    return dict(zip(order, volumes))


def frozen(changes):
    return tuple(sorted(changes.items()))


def run(sim, folder, quick):
    if quick:
        found = measured(sim, [(rule, 0.5, 0, ()) for rule in RULES])
        return {f"cuts.{rule}.burnt_mm3.half_the_cells": found[rule, 0.5, 0, ()] for rule in RULES}, None
    cases = [(rule, fineness, offset, ()) for rule in RULES for fineness in MESHES for offset in range(OFFSETS)]
    cases += [(rule, 1, 0, frozen(changes)) for rule in RULES for _, changes in VARIANTS if changes]
    volumes = measured(sim, cases)
    meshes = {(rule, fineness): [volumes[rule, fineness, k, ()] for k in range(OFFSETS)]
              for rule in RULES for fineness in MESHES}
    variants = {(rule, name): volumes[rule, 1, 0, frozen(changes)] for rule in RULES for name, changes in VARIANTS}
    plots.plot(plots.picture(folder, "cuts"), "What a cut of 40 mm takes, by the mesh", "cells along an edge, of the shipped ones",
               "volume, mm^3", [(f"by {rule}{what}", [(f, of(meshes[rule, f])) for f in MESHES])
                                for rule in RULES for what, of in (("", mean), (", least", min), (", most", max))],
               extra=["set yrange [0:*]"])
    return {}, {"meshes": meshes, "variants": variants}


def mean(values):
    return sum(values) / len(values)


def page(found):
    if found is None:
        return ""
    meshes, variants = found["meshes"], found["variants"]

    def cells(rule, fineness):
        of = meshes[rule, fineness]
        return f"{mean(of):.0f} ({min(of):.0f} to {max(of):.0f}) | {mean(of) / mean(meshes[rule, 1]):.2f}"
    by_mesh = [f"| {fineness:g} | {cells('edges', fineness)} | {cells('elements', fineness)} |" for fineness in MESHES]
    by_step = [f"| {name} | {variants['edges', name]:.0f} | {variants['elements', name]:.0f} |" for name, _ in VARIANTS]
    return f"""## What a cut depends on

    build/bin/cautery-sim --scene fat-neohookean --cut --vtu DIR
    build/tests/test_core_session_cut_by_mesh --long

The scene `fat-neohookean`, on a slab of {1e3 * SIZE_M[0]:.0f} x {1e3 * SIZE_M[1]:.0f} x {1e3 * SIZE_M[2]:.0f} mm with cells of 2 mm, is cut for {2e3 * HALF_M:.0f} mm along its middle. The table has the rest volume
of the removed tetrahedra, by the scene's `parting`. *Edges* is the paper's rule: a parted edge removes all elements
that share it. *Elements* parts each tetrahedron by the dose at its middle. The table has the
mean over {OFFSETS} paths with different positions in the cells, and the least and the greatest volume in parentheses. The columns
"of 1 x" have this mean divided by the mean with the shipped cells.

| cells along an edge | by edges, mm^3 | of 1 x | by elements, mm^3 | of 1 x |
|---:|---:|---:|---:|---:|
{chr(10).join(by_mesh)}

By edges, half a cell on all sides is removed together with the parted elements, so a coarse mesh loses more. By
elements, the mesh loses only the tissue that the heat reaches. Two tests compare the mean volume of eight paths between meshes. The mean may change by at most 15 % over meshes of 1 to
2 x the cells, and by at most 30 % at 0.5 x. The test
`core_session_cut_by_mesh` runs such sessions with steps of 1/30 s. It runs the meshes 0.5 x and 1 x in every run, and
finer meshes with `--long`. The test `core_dissect_doses` runs the cuts on tissue at rest.

![Volume by mesh](validation-cuts.svg)

The next table has the removed volume with the shipped cells and one path, by the length of the step and by the number
of iterations. Without a number of iterations, a step ends at an estimated error of 1 %.

| steps | by edges, mm^3 | by elements, mm^3 |
|---|---:|---:|
{chr(10).join(by_step)}
"""
