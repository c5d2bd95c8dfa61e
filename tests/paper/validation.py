# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: what a cut depends on, strain limits by load, and error by iterations, by scene."""

import math

import strain_limits
from costs import bench
from vtu import TETRAHEDRON

STEPS_PER_S = 60
HALF_M = 0.02  # of the cut
MESHES = (("0.5", [25, 13, 2]), ("1", [50, 25, 4]), ("1.5", [75, 38, 6]))
VARIANTS = (("step 1/120 s", {"step_s": 1 / 120}), ("5 iterations", {"iterations": 5, "accuracy": 0}),
            ("20 iterations", {"iterations": 20, "accuracy": 0}))
LOADS_M_S2 = (1, 3, 9.81, 30)
SHEET = "strain-xy-on"
ERRORS = ("fascia", "fat", "fat-neohookean", "layers", "strain-xy-on")


def volume(rest, cell):
    a, b, c, d = (rest.position_m[v] for v in cell)
    e = [[q - p for p, q in zip(a, corner)] for corner in (b, c, d)]
    cross = (e[1][1] * e[2][2] - e[1][2] * e[2][1], e[1][2] * e[2][0] - e[1][0] * e[2][2],
             e[1][0] * e[2][1] - e[1][1] * e[2][0])
    return abs(sum(p * q for p, q in zip(e[0], cross))) / 6


def burnt_mm3(sim, cells, changes):
    """Rest volume of the tetrahedra of `fat-neohookean` that a cut of 40 mm takes."""
    scene = sim.scene("fat-neohookean")
    scene["meshes"][0]["cells"] = cells
    scene |= changes
    scene["tools"][0]["position_m"] = [-HALF_M, 0, 0.02]
    scene["cut"] |= {"from_m": [-HALF_M, 0, 0], "to_m": [HALF_M, 0, 0]}
    steps_per_s = round(1 / scene.get("step_s", 1 / STEPS_PER_S))
    seconds = math.ceil(6 + 2 * HALF_M / scene["cut"]["speed_m_s"])
    run = sim.run(scene, cut=True, seconds=seconds, states_every=seconds * steps_per_s)
    whole, left = run.states[0], run.states[max(run.states)]
    alive = {cell for cell, kind in zip(left.cells, left.kind) if kind == TETRAHEDRON}
    return 1e9 * sum(volume(whole, cell) for cell, kind in zip(whole.cells, whole.kind)
                     if kind == TETRAHEDRON and cell not in alive)


def hang(sim, load_m_s2):
    """Strains along both axes that 99 % of a hanging sheet's triangles stay below, and the largest."""
    scene = sim.scene(SHEET)
    scale = load_m_s2 / math.hypot(*scene["gravity_m_s2"])
    scene |= {"iterations": strain_limits.ITERATIONS, "accuracy": 0,
              "gravity_m_s2": [scale * g for g in scene["gravity_m_s2"]]}
    seconds = strain_limits.HANGING_S
    run = sim.run(scene, seconds=seconds, states_every=seconds * STEPS_PER_S)
    rest, end = run.states[0], run.states[max(run.states)]
    values = [strain_limits.strains(rest, end, axis) for axis in strain_limits.axes_of(scene)]
    return [(of[int(strain_limits.WHERE * (len(of) - 1))], of[-1]) for of in values]


def run(sim, _folder, quick):
    if quick:
        figures = {"validation.burnt_mm3.half_the_cells": burnt_mm3(sim, MESHES[0][1], {})}
        for axis, (below, largest) in enumerate(hang(sim, LOADS_M_S2[0])):
            figures |= {f"validation.{SHEET}.axis_{axis + 1}.strain_99": below,
                        f"validation.{SHEET}.axis_{axis + 1}.largest": largest}
        return figures, None
    meshes = [(name, burnt_mm3(sim, cells, {})) for name, cells in MESHES]
    variants = [(name, burnt_mm3(sim, MESHES[1][1], changes)) for name, changes in VARIANTS]
    loads = [(load, hang(sim, load)) for load in LOADS_M_S2]
    errors = [(scene, bench(sim, scene, 20, "--error")) for scene in ERRORS]
    return {}, {"meshes": meshes, "variants": variants, "loads": loads, "errors": errors}


def error_rows(errors):
    curve = [point["iterations"] for point in errors[0][1]["error_curve"]]
    rows = [f"| scene | {' | '.join(str(k) for k in curve)} | ms at 1 % |", "|---|" + "---:|" * (len(curve) + 1)]
    for scene, of in errors:
        cells = " | ".join(f"{100 * point['error']:.2g} %" for point in of["error_curve"])
        rows.append(f"| `{scene}` | {cells} | {of['ms_to_1pct']:.2f} |")
    return rows


def page(found):
    if found is None:
        return ""
    cuts = [f"| {name} x the cells | {mm3:.0f} |" for name, mm3 in found["meshes"]]
    cuts += [f"| {name} | {mm3:.0f} |" for name, mm3 in found["variants"]]
    loads = [f"| {load:g} | {a[0]:.1%}, {a[1]:.1%} | {b[0]:.1%}, {b[1]:.1%} |" for load, (a, b) in found["loads"]]
    return f"""## Validation: what a cut depends on

`fat-neohookean`, cut for {2e3 * HALF_M:.0f} mm along its middle: rest volume of the tetrahedra that go, by the fineness of the mesh,
and with the shipped mesh by step and iterations (the shipped scene ends its steps at an error of 1 %).

| | burnt away, mm^3 |
|---|---:|
{chr(10).join(cuts)}

The edge rule takes all elements that share a parted edge, so a coarser mesh loses more: that is the paper's rule, and
a cut here still depends on the mesh as much as the first rows say.

## Validation: strain limits by load

The sheet `{SHEET}`, 2 % allowed along both axes, hung by two corners in {len(LOADS_M_S2)} gravities: strain that 99 % of the
triangles stay below, and the largest.

| gravity, m/s^2 | axis 1: 99 %, largest | axis 2: 99 %, largest |
|---:|---:|---:|
{chr(10).join(loads)}

## Validation: error by iterations

`cautery-bench --scene NAME --error`: mean error of steps of so many iterations against the converged step, relative to
the step's own motion, under the scene's pull.

{chr(10).join(error_rows(found["errors"]))}
"""
