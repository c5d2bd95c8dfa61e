# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 4: sheets that hang by the ends of one edge, under three strain limits and two ways of the fibres."""

import math

import geometry
from drawing import Montage

SHEETS = [f"strain-{limit}-{axes}" for limit in ("none", "x", "xy") for axes in ("off", "on")]
HANGING_S, LAST_S = 8, 2
ITERATIONS = 100  # of each step, so that what hangs is at rest and converged
STEPS_PER_S = 60
WHERE = 0.99  # the share of triangles of which the strain is told beside the largest


def axes_of(scene):
    turn = scene["meshes"][0].get("texture_turn_rad", 0)
    return [(math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))]


def strains(rest, now, axis):
    return sorted(geometry.strain([rest.position_m[v] for v in cell], [now.position_m[v] for v in cell], axis)
                  for cell in rest.triangles())


def motion_mm(before, after):
    return 1e3 * max(math.dist(a, b) for a, b in zip(before.position_m, after.position_m))


def rows_and_columns(scene, state):
    """Polylines along each fourth row and column of the sheet's vertices, and its outline."""
    columns, rows = (cells + 1 for cells in scene["meshes"][0]["cells"])
    grid = [state.position_m[row * columns:(row + 1) * columns] for row in range(rows)]
    turned = list(zip(*grid))
    outline = [*grid[0], *turned[-1], *grid[-1][::-1], *turned[0][::-1]]
    lines = [(line, "#a9714e", 0.6) for line in [*grid[::4], *turned[::4]]]
    return [(outline, "#e0b08a")], lines


def hang(sim, name, montage):
    scene = sim.scene(name)
    scene |= {"iterations": ITERATIONS, "accuracy": 0}
    ticks, last = HANGING_S * STEPS_PER_S, LAST_S * STEPS_PER_S
    run = sim.run(scene, seconds=HANGING_S, states_every=last)
    rest, before, end = run.states[0], run.states[ticks - last], run.states[ticks]
    montage.add(name, (0.01, -0.045), *rows_and_columns(scene, end))
    columns = []
    for axis, limit in zip(axes_of(scene), scene["layers"][0]["strain_max"]):
        values = strains(rest, end, axis)
        columns.append({"limit": limit, "share": values[int(WHERE * (len(values) - 1))], "largest": values[-1]})
    return {"sheet": name, "axes": columns, "moved_mm": motion_mm(before, end)}


def run(sim, folder, quick):
    montage = Montage(2, 260, 260, 1150)
    sheets = [hang(sim, name, montage) for name in (SHEETS[-2:] if quick else SHEETS)]
    if not quick:
        montage.write(f"{folder}/figure-4.svg")
    return {f"figure_4.{s['sheet']}.axis_{i + 1}.strain_99": axis["share"]
            for s in sheets for i, axis in enumerate(s["axes"])}, sheets


def page(sheets):
    rows = ["| sheet | axis | asked: at most | 99 % of triangles stay below | largest |", "|---|---|---:|---:|---:|"]
    for sheet in sheets:
        for i, axis in enumerate(sheet["axes"]):
            rows.append(f"| `{sheet['sheet']}` | {i + 1} | {axis['limit']:.0%} | {axis['share']:.1%} | "
                        f"{axis['largest']:.1%} |")
    moved = max(sheet["moved_mm"] for sheet in sheets)
    return f"""## Figure 4: strain limits by axis

Six sheets of 100 mm hang by the ends of their upper edge for {HANGING_S} s and are not
cut. Each step has {ITERATIONS} iterations. The top sheets may stretch by 60 % along both material axes. The middle sheets may stretch by 2 % along the first
axis and by 60 % along the second axis. The bottom sheets may stretch by 2 % along both axes. On the left, the material
axes are turned by 0.5 rad against the mesh's axes. On the right, both agree. As in the paper, the top sheets become
long. The middle sheets shear or narrow to follow their stiff fibres. The bottom sheets keep their shape.

![Six hanging sheets](figure-4.svg)

{chr(10).join(rows)}

Strain is |F a| - 1 of each triangle along its material axis a. The paper gives no numbers of strain. Beyond a limit the
tissue has a finite stiffness (`limit_stiffness_pa`), so strain can exceed the limit. Strain exceeds the limit by
much only in few triangles, beside the two pins, because the pins carry the whole weight. In the last two seconds no vertex moved further than
{moved:.2g} mm.
"""
