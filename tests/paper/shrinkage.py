# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 6 and eq. 21: the same cut through taut fascia with shrinkage and without, along and across."""

import geometry
from drawing import Montage

HALF_M = 0.02  # of the cut
WAYS = {"along": ((-HALF_M, 0), (HALF_M, 0)), "across": ((0, -HALF_M), (0, HALF_M))}
SHRINKS = {"off": [1, 1], "on": [0.1, 0.3]}  # S_x, S_y; the second are the paper's
TARGETS = {"mild": [0.8, 0.8, 0], "taut": [0.1, 0.1, 0]}  # T; the second is the paper's
CASES = [("mild", way, shrink) for way in WAYS for shrink in SHRINKS]
CASES += [("taut", "along", shrink) for shrink in SHRINKS]
SPEED_M_S = 0.002
SECONDS, STEPS_PER_S = 30, 60  # the way there, 3 s of heating, 20 s of cutting, and rest
VIEW_M = 0.03  # half the side of what is drawn


def cut_scene(sim, tension, way, shrink):
    scene = sim.scene("fascia")
    scene["layers"][0] |= {"shrink": SHRINKS[shrink], "target": TARGETS[tension]}
    start, end = WAYS[way]
    scene["tools"][0]["position_m"] = [*start, 0.05]
    scene["cut"] |= {"from_m": [*start, 0], "to_m": [*end, 0], "speed_m_s": SPEED_M_S}
    return scene


def area(points):
    return abs(geometry.turn(*(p[:2] for p in points))) / 2


def edges_of(cells):
    count = {}
    for cell in cells:
        for i in range(3):
            edge = tuple(sorted((cell[i], cell[(i + 1) % 3])))
            count[edge] = count.get(edge, 0) + 1
    return {edge for edge, cells_of in count.items() if cells_of == 1}


def lips(whole, left):
    """Edges that have one triangle now and had two: the incision's border."""
    return edges_of(left.triangles()) - edges_of(whole.triangles())


def measure(whole, left):
    gone = set(whole.triangles()) - set(left.triangles())
    full = sum(area([whole.position_m[v] for v in cell]) for cell in whole.triangles())
    now = sum(area([left.position_m[v] for v in cell]) for cell in left.triangles())
    burnt = sum(area([whole.position_m[v] for v in cell]) for cell in gone)
    length = 2 * HALF_M
    return {"elements": len(gone), "burnt_mm": 1e3 * burnt / length, "open_mm": 1e3 * (full - now) / length}


def cut(sim, tension, way, shrink, montage):
    scene = cut_scene(sim, tension, way, shrink)
    run = sim.run(scene, cut=True, seconds=SECONDS, states_every=SECONDS * STEPS_PER_S)
    whole, left = run.states[0], run.states[max(run.states)]
    border = [([left.position_m[v] for v in edge], "#7a2e1d", 1.2) for edge in sorted(lips(whole, left))]
    square = [(x * VIEW_M, y * VIEW_M) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    montage.add(f"{tension}, {way}, shrinkage {shrink}", (0, 0), [(square, "#efd3b8")], border)
    return {"tension": tension, "way": way, "shrink": shrink, **measure(whole, left)}


def run(sim, folder, quick):
    montage = Montage(2, 270, 270, 4200)
    cuts = [cut(sim, *case, montage) for case in (CASES[:2] if quick else CASES)]
    if not quick:
        montage.write(f"{folder}/figure-6.svg")
    return {f"figure_6.{c['tension']}.{c['way']}.{c['shrink']}.open_mm": c["open_mm"] for c in cuts}, cuts


def page(cuts):
    rows = ["| T | cut | S | triangles gone | burnt away, mm wide | open, mm wide |", "|---|---|---|---:|---:|---:|"]
    rows += [f"| {TARGETS[c['tension']][:2]} | {c['way']} | {SHRINKS[c['shrink']]} | {c['elements']} | {c['burnt_mm']:.2f} | {c['open_mm']:.2f} |"
             for c in cuts]
    return f"""## Figure 6: shrinkage beside the cut

The scene `fascia` has the paper's values: tool 170 degC, ignition 160 degC, xi 0.4. It gets a cut of {2e3 * HALF_M:.0f}
mm at {1e3 * SPEED_M_S:.0f} mm/s, along or across the sheet. Each cut is made without shrinkage (S = 1) and with the
paper's S of 0.1 and 0.3. The target T is the square of the length to which the sheet tends, relative to its present length. One sheet is
mildly taut (T = 0.8, so it tends to nine tenths of its length). The other sheet is the paper's (T = 0.1, so it tends to
a third of its length). A width in the table is an area divided by the length of the cut. "Burnt away" uses the area of the removed triangles at
rest, and "open" uses the area of the opening at the end.

![Borders of the incisions](figure-6.svg)

{chr(10).join(rows)}

In the mildly taut sheet, shrinkage moves the lips apart by {widening(cuts, 'mild', 'along'):.1f} mm in the cut along and
{widening(cuts, 'mild', 'across'):.1f} mm in the cut across. In the paper's sheet shrinkage changes the opening by
{widening(cuts, 'taut', 'along'):+.1f} mm. Tension opens the cut by far more than the shrinkage beside the cut. So figure
6 shows the effect of shrinkage only if tension is small. (A sheet without tension moves away from the hook and is
not cut at all.)
"""


def widening(cuts, tension, way):
    width = {c["shrink"]: c["open_mm"] for c in cuts if c["tension"] == tension and c["way"] == way}
    return width["on"] - width["off"] if len(width) == 2 else 0
