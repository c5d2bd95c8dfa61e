# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: strain limits as asked and as reached, by load."""

import math

import plots
import strain_limits
from sim import at_once

LOADS_M_S2 = (0.3, 1, 3, 9.81, 30)
SHEET, LIMIT = "strain-xy-on", 0.02


def hang(sim, load_m_s2):
    """Strains along both axes that 99 % of a hanging sheet's triangles stay below, and the largest."""
    scene = sim.scene(SHEET)
    scale = load_m_s2 / math.hypot(*scene["gravity_m_s2"])
    scene |= {"iterations": strain_limits.ITERATIONS, "accuracy": 0,
              "gravity_m_s2": [scale * g for g in scene["gravity_m_s2"]]}
    seconds = strain_limits.HANGING_S
    run = sim.run(scene, seconds=seconds, states_every=seconds * strain_limits.STEPS_PER_S)
    rest, end = run.states[0], run.states[max(run.states)]
    values = [strain_limits.strains(rest, end, axis) for axis in strain_limits.axes_of(scene)]
    return [(of[int(strain_limits.WHERE * (len(of) - 1))], of[-1]) for of in values]


def run(sim, folder, quick):
    loads = LOADS_M_S2[1:2] if quick else LOADS_M_S2
    found = dict(zip(loads, at_once([lambda load=load: hang(sim, load) for load in loads])))
    figures = {}
    for axis, (below, largest) in enumerate(found[1]):
        figures |= {f"loads.{SHEET}.axis_{axis + 1}.strain_99": below,
                    f"loads.{SHEET}.axis_{axis + 1}.largest": largest}
    if not quick:
        series = [(f"axis {axis + 1}, {what}", [(load, 100 * of[axis][k]) for load, of in found.items()])
                  for axis in (0, 1) for k, what in enumerate(("99 % of triangles", "largest"))]
        series.append(("asked", [(load, 100 * LIMIT) for load in found]))
        plots.plot(plots.picture(folder, "loads"), "Strain of a hanging sheet, 2 % allowed", "gravity, m/s^2", "strain, %", series,
                   logscale="x")
    return figures, found


def page(found):
    rows = [f"| {load:g} | {a[0]:.1%}, {a[1]:.1%} | {b[0]:.1%}, {b[1]:.1%} |" for load, (a, b) in found.items()]
    return f"""## Strain limits by load

    build/bin/cautery-sim --scene {SHEET} --seconds {strain_limits.HANGING_S} --vtu DIR

The sheet `{SHEET}` may stretch by {LIMIT:.0%} along both axes and hangs by two corners. It hangs in {len(LOADS_M_S2)} gravities (the same
scene with other values of `gravity_m_s2`), with {strain_limits.ITERATIONS} iterations a step. The table has the strain
below which 99 % of the triangles stay, and the largest strain.

| gravity, m/s^2 | axis 1: 99 %, largest | axis 2: 99 %, largest |
|---:|---:|---:|
{chr(10).join(rows)}

A strain limit is not a wall: beyond the limit the tissue has a finite stiffness (`limit_stiffness_pa`). So the strain
above {LIMIT:.0%} grows with the load.

![Strain by load](validation-loads.svg)
"""
