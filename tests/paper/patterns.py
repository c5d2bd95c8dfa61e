# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 5: which patterns of incision the edge-based rule reaches, beside removing what is touched."""

import math
import random

import geometry
from drawing import Montage

FANS = (3, 4, 5, 6, 8, 12)
RADIUS_M = 0.006
NEEDLE_M = 0.0008  # its radius: thin enough to touch one edge alone
SPEEDS_M_S = (0.0002, 0.002)
DOSE_S = 15  # an edge has the mean temperature of its ends, which warm from afar
STEPS_PER_S = 60
SEED = 5


def fan_scene(sim, count):
    """The fan of `count` triangles alone, about the origin, stiff and at rest."""
    shipped = sim.scene("patterns")
    mesh = next(m for m in shipped["meshes"] if m["name"] == f"fan-{count}")
    layer = next(of for of in shipped["layers"] if of["mesh"] == mesh["name"])
    needle = dict(shipped["tools"][0], hot_radius_m=NEEDLE_M, shape="sphere", grid_step_m=NEEDLE_M / 3,
                  grid_cells=32, position_m=[0, 0, 0.02])
    return dict(shipped, name=f"fan-{count}", meshes=[dict(mesh, translate_m=[0, 0, 0])],
                layers=[dict(layer, target=[1, 1, 0])], pins=[{"kind": "rim", "layer": layer["name"]}],
                tools=[needle])


def go(tick, place):
    return {"command": "tool.move", "tick": tick, "tool": "needle", "position_m": list(place),
            "rotation": [1, 0, 0, 0], "jaw": 0}


def energy(tick, on):
    return {"command": "tool.energize", "tick": tick, "tool": "needle", "energized": on}


def stroke(start, end, duration_s):
    """Commands: down at `start`, on, evenly to `end`, off. Returns them and the tick after."""
    lines = [go(60, (*start, 0.004)), go(120, (*start, 0)), energy(180, True)]
    ticks = max(1, round(duration_s * STEPS_PER_S))
    for tick in range(1, ticks + 1):
        share = tick / ticks
        lines.append(go(180 + tick, (*(a + (b - a) * share for a, b in zip(start, end)), 0)))
    return [*lines, energy(181 + ticks, False)], 190 + ticks


def burn(sim, scene, start, end, duration_s):
    """(triangles of the whole fan, those that are gone, positions)"""
    script, ticks = stroke(start, end, duration_s)
    run = sim.run(scene, script=script, seconds=ticks / STEPS_PER_S, states_every=ticks)
    whole, left = run.states[0], run.states[max(run.states)]
    return whole, frozenset(set(whole.triangles()) - set(left.triangles()))


def random_stroke(chance):
    def point():
        turn, reach = chance.uniform(0, 2 * math.pi), RADIUS_M * math.sqrt(chance.random())
        return reach * math.cos(turn), reach * math.sin(turn)
    start, end = point(), point()
    speed = SPEEDS_M_S[0] * (SPEEDS_M_S[1] / SPEEDS_M_S[0]) ** chance.random()
    return start, end, max(0.2, math.dist(start, end) / speed)


def touched(whole, start, end):
    """What a rule removes that removes every element which the needle touches."""
    return frozenset(cell for cell in whole.triangles()
                     if geometry.triangle_distance([whole.position_m[v][:2] for v in cell], start, end) <= NEEDLE_M)


def single_edges(whole):
    """Where the needle touches one spoke alone, and one side of the rim alone."""
    hub, first, second = (whole.position_m[v][:2] for v in whole.triangles()[0])
    along_side_m = min(3 * NEEDLE_M, math.dist(first, second) / 2)

    def between(a, b, away_m):
        share = away_m / math.dist(a, b)
        return tuple(p + (q - p) * share for p, q in zip(a, b))
    return {"spoke": between(first, hub, 2.5 * NEEDLE_M), "side": between(first, second, along_side_m)}


def coloured(whole, gone, stroke_line=None):
    cells = [([whole.position_m[v] for v in cell], "#4a3a36" if cell in gone else "#e0b08a")
             for cell in whole.triangles()]
    return cells, [(stroke_line, "#1f6fb2", 2)] if stroke_line else []


def fan(sim, count, strokes, montage):
    scene = fan_scene(sim, count)
    found = {"triangles": count, "strokes": strokes, "single": {}}
    whole, _ = burn(sim, scene, (2 * RADIUS_M, 0), (2 * RADIUS_M, 0), 0.1)
    for name, place in single_edges(whole).items():
        gone = burn(sim, scene, place, place, DOSE_S)[1]
        found["single"][name] = len(gone)
        montage.add(f"{count} triangles, one {name}", (0, 0), *coloured(whole, gone, (place, place)))
    chance, by_edges, by_touch, drawn = random.Random(SEED), set(), set(), None
    for _ in range(strokes):
        start, end, duration_s = random_stroke(chance)
        gone, removed = burn(sim, scene, start, end, duration_s)[1], touched(whole, start, end)
        by_edges.add(gone)
        by_touch.add(removed)
        if gone and gone != removed and not drawn:
            drawn = (start, end), gone, removed
    if drawn:
        for name, cells in (("edge rule", drawn[1]), ("by touch", drawn[2])):
            montage.add(f"{count} triangles, {name}", (0, 0), *coloured(whole, cells, drawn[0]))
    return {**found, "edges": len(by_edges), "touch": len(by_touch), "edges_alone": len(by_edges - by_touch)}


def run(sim, folder, quick):
    montage = Montage(4, 190, 190, 13000)
    fans = [fan(sim, count, 10 if quick else 100, montage) for count in ((4, 6) if quick else FANS)]
    if not quick:
        montage.write(f"{folder}/figure-5.svg")
    figures = {}
    for found in fans:
        name = f"figure_5.fan_{found['triangles']}"
        figures |= {f"{name}.{edge}": gone for edge, gone in found["single"].items()}
        figures |= {f"{name}.by_edges": found["edges"], f"{name}.by_touch": found["touch"]}
    return figures, fans


def page(fans):
    rows = ["| triangles of the fan | gone with one spoke | with one side of the rim | patterns by the edge rule | "
            "by touch | by the edge rule alone |", "|---:|---:|---:|---:|---:|---:|"]
    rows += [f"| {f['triangles']} | {f['single']['spoke']} | {f['single']['side']} | {f['edges']} | {f['touch']} | "
             f"{f['edges_alone']} |" for f in fans]
    return f"""## Figure 5: patterns of incision

The figure has fans of triangles about one vertex, at rest. First, a needle of {1e3 * NEEDLE_M:.1f} mm is held on one edge for
{DOSE_S} s. The edge parts, and the triangles of this edge are removed. So a dose of heat parts single edges. Then the
needle makes {fans[0]['strokes']} random strokes, straight, of {1e3 * SPEEDS_M_S[0]:.1f} to {1e3 * SPEEDS_M_S[1]:.0f}
mm/s, the same for every fan. The table counts the different sets of remaining triangles: by the edge rule with heat,
and by a rule that removes each triangle that the needle touches.

![Fans after one dose, and after one stroke by either rule](figure-5.svg)

{chr(10).join(rows)}

The paper says that its data structure makes more patterns than structures that remove polygons (section 7.1). {verdict(fans)} The
last column counts the sets that remained only by the edge rule, and never by the rule of touch. By the edge rule,
triangles whose edges had too little heat remain beside removed triangles. The rule of touch removes all of these
triangles. The rule of touch also makes patterns that heat does not make, because it removes single triangles that the
needle only brushed. So the strokes decide which rule makes more patterns. Each rule makes patterns that the other rule
does not make.
"""


def verdict(fans):
    more = [f for f in fans if f["edges"] > f["touch"]]
    if len(more) == len(fans):
        return "By this count the edge rule makes more patterns for every fan."
    return f"By this count the edge rule makes more patterns for {len(more)} of {len(fans)} fans."
