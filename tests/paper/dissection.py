# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 7: fascia, and fat in its membrane, under the instrument, as sequences, and what their cuts are like."""

import json
import math
from dataclasses import dataclass, replace

from drawing import Montage
from shrinkage import edges_of
from sim import at_once

STEPS_PER_S = 60
REST_S = 5  # after the cut
STATES, DRAWN = 8, (3, 4, 6, 8)  # states of a run, and those that are drawn
REACH_M = 0.045  # on either side, within which a gap is the cut's
HALF_WIDTH_M = 0.002  # of the strip that strands cross
CHARRED = 0.5  # of an ignition's dose
VIEW_M = 0.036  # half the width of what is drawn
STATIONS = 61  # lines across the cut on which its lips are looked for
WINDOW_M = 0.01  # of the running mean that a lip's roughness is taken from
SAG_M = 0.003  # a layer that is seen from above may hang through by so much at rest


# ---- measures, all of what is on top of the tissue and seen from above
def clipped(triangle, x):
    """The y interval in which the line x = const crosses a triangle of the plane, or None."""
    ys = []
    for (ax, ay), (bx, by) in zip(triangle, triangle[1:] + triangle[:1]):
        if (ax <= x) != (bx <= x):
            ys.append(ay + (by - ay) * (x - ax) / (bx - ax))
    return (min(ys), max(ys)) if ys else None


def gaps(triangles, x, reach_m):
    """Intervals of y within `reach_m` that no triangle covers on the line x = const, between tissue on both sides."""
    crossed = [clipped(t, x) for t in triangles if min(p[0] for p in t) <= x < max(p[0] for p in t)]
    found, end = [], None
    for low, high in sorted(c for c in crossed if c and c[1] > -reach_m and c[0] < reach_m):
        if end is not None and low > end + 1e-6:
            found.append((end, low))
        end = high if end is None else max(end, high)
    return found


def roughness(stations, lip):
    """Root mean square of a lip's distance from its running mean over WINDOW_M."""
    squares = []
    for x, y in zip(stations, lip):
        near = [other for at, other in zip(stations, lip) if abs(at - x) <= WINDOW_M / 2]
        squares.append((y - sum(near) / len(near)) ** 2)
    return math.sqrt(sum(squares) / len(squares)) if squares else 0.0


def pieces(cells):
    """Cells in groups that hang together by vertices."""
    root = {}

    def find(v):
        while root.setdefault(v, v) != v:
            root[v] = root[root[v]]
            v = root[v]
        return v
    for cell in cells:
        for v in cell[1:]:
            root[find(v)] = find(cell[0])
    groups = {}
    for cell in cells:
        groups.setdefault(find(cell[0]), []).append(cell)
    return list(groups.values())


def strands(rest, cells, half_length_m, half_width_m):
    """(pieces that join both sides of the strip about the cut, pieces in it that join neither)"""
    strip = [cell for cell in cells
             if abs(sum(rest[v][0] for v in cell) / 3) < half_length_m
             and min(abs(rest[v][1]) for v in cell) < half_width_m]
    across = alone = 0
    for piece in pieces(strip):
        ys = [rest[v][1] for cell in piece for v in cell]
        joins = max(ys) >= half_width_m, min(ys) <= -half_width_m
        across += all(joins)
        alone += not any(joins)
    return across, alone


def top_cells(whole, state, layer):
    top = max(whole.position_m[v][2] for cell in whole.triangles(layer) for v in cell) - SAG_M
    return [cell for cell in state.triangles(layer) if all(whole.position_m[v][2] >= top for v in cell)]


def seen(state, way):
    """The state with x along the cut and y across it."""
    return state if way == "x" else replace(state, position_m=[(y, x, z) for x, y, z in state.position_m])


def measure(whole, state, layer, half_length_m, half_width_m):
    cells = top_cells(whole, state, layer)
    flat = [[state.position_m[v][:2] for v in cell] for cell in cells]
    stations, lower, upper, widths = [], [], [], []
    for k in range(STATIONS):
        x = half_length_m * (2 * k / (STATIONS - 1) - 1)
        found = gaps(flat, x, REACH_M)
        widths.append(1e3 * sum(b - a for a, b in found))
        if found:
            stations.append(x)
            lower.append(found[0][0])
            upper.append(found[-1][1])
    across, _ = strands(whole.position_m, cells, half_length_m, half_width_m)
    charred = [cell for cell in cells if sum(state.exposure[v] for v in cell) / 3 > CHARRED]
    return {"strands": across, "gone": len(top_cells(whole, whole, layer)) - len(cells), "charred": len(charred),
            "least_mm": min(widths), "mean_mm": sum(widths) / len(widths), "most_mm": max(widths),
            "rough_mm": 1e3 * (roughness(stations, lower) + roughness(stations, upper)) / 2}


# ---- pictures
def loops(edges):
    """Closed walks along edges, each edge once; every vertex has an even number of them."""
    beside = {}
    for edge in sorted(edges):
        for v, other in (edge, edge[::-1]):
            beside.setdefault(v, []).append(other)
    walks = []
    for start in sorted(beside):
        while beside[start]:
            walk = [start]
            while True:
                last = walk[-1]
                if not beside[last]:
                    break
                nearest = beside[last].pop()
                beside[nearest].remove(last)
                walk.append(nearest)
            walks.append(walk)
    return walks


def picture(montage, title, whole, state, layer, tip):
    """What is open, dark; what is charred beside it, brown; the instrument's hot part, a ring."""
    cells, all_cells = top_cells(whole, state, layer), top_cells(whole, whole, layer)
    border = edges_of(cells) - edges_of(all_cells)
    square = [(x * VIEW_M, y * VIEW_M) for x, y in ((-1, -0.75), (1, -0.75), (1, 0.75), (-1, 0.75))]
    charred = [([state.position_m[v] for v in cell], "#8a5a3a") for cell in cells
               if sum(state.exposure[v] for v in cell) / 3 > CHARRED]
    lines = [([state.position_m[v] for v in edge], "#5a2416", 1.0) for edge in sorted(border)]
    turns = [k * math.pi / 12 for k in range(25)]
    lines.append(([(tip[0] + tip[2] * math.cos(t), tip[1] + tip[2] * math.sin(t)) for t in turns], "#1f6fb2", 1.5))
    hole = [[state.position_m[v] for v in walk] for walk in loops(border)]
    montage.add(title, (0, 0), [(square, "#efd3b8"), *charred], lines, hole)


# ---- scenes
def lead(scene, way, half_m, speed_m_s):
    start, end = ([-half_m, 0, 0], [half_m, 0, 0]) if way == "x" else ([0, -half_m, 0], [0, half_m, 0])
    scene["tools"][0]["position_m"] = [*start[:2], 0.02]
    scene["cut"] |= {"from_m": start, "to_m": end, "speed_m_s": speed_m_s}
    return scene


def fascia(sim):
    return lead(sim.scene("fascia"), "x", 0.03, 0.002)


def frayed_fascia(sim):
    """Bundles of fibres that lie across the cut and part unevenly, under a thinner hook, drawn faster."""
    scene = lead(sim.scene("fascia"), "x", 0.03, 0.004)
    scene["seed"] = 5
    scene["meshes"][0]["texture_turn_rad"] = math.pi / 2
    scene["layers"][0] |= {"fibre": [0, 1, 0], "ignition_spread_c": 17, "ignition_bundle_m": 0.002}
    scene["tools"][0]["hot_radius_m"] = 0.002
    return scene


def fat(sim):
    return lead(sim.scene("fat"), "x", 0.02, 0.002)


def frayed_fat(sim):
    """Cut across its tension, which its membrane has too, in bundles that part unevenly."""
    scene = lead(sim.scene("fat"), "y", 0.02, 0.004)
    scene["seed"] = 5
    scene["layers"][0]["ignition_spread_c"] = 2.9
    scene["layers"][0]["ignition_bundle_m"] = 0.002
    scene["layers"][1] |= {"target": [0.3, 1, 0], "ignition_spread_c": 4.1, "ignition_bundle_m": 0.002}
    return scene


CASES = (  # name, scene, way of the cut, layer that is looked at
    ("fascia", fascia, "x", 0),
    ("fascia, frayed", frayed_fascia, "x", 0),
    ("fat", fat, "x", 1),
    ("fat, frayed", frayed_fat, "y", 1),
)


@dataclass
class Cut:
    """States of a cut, seen with x along it, the tool's tips and their hot radius, and what it is like at its end."""

    name: str
    layer: int
    states: dict
    tips: dict
    radius_m: float
    measures: dict

    @property
    def last(self):
        return max(self.states)

    def draw(self, montage, title, tick):
        picture(montage, title, self.states[0], self.states[tick], self.layer, (*self.tips[tick], self.radius_m))


def length_m(scene):
    return math.dist(scene["cut"]["from_m"], scene["cut"]["to_m"])


def ticks_of(scene):
    """Of the cut and the rest after it, in whole intervals of the states that are kept."""
    cut = scene["cut"]
    seconds = 3 + cut["dwell_s"] + length_m(scene) / cut["speed_m_s"] + REST_S
    return round(seconds * STEPS_PER_S / STATES) * STATES


made = {}  # a scene as JSON: its run. `parting` makes the same cuts by the rule that scenes have by default, and by the other


def run_of(sim, scene, ticks):
    key = json.dumps({"parting": "edges"} | scene, sort_keys=True)
    if key not in made:
        made[key] = sim.run(scene, cut=True, seconds=ticks / STEPS_PER_S, states_every=ticks // STATES)
    return made[key]


def dissect(sim, name, make, way, layer):
    scene = make(sim)
    ticks = ticks_of(scene)
    run = run_of(sim, scene, ticks)
    states = {tick: seen(state, way) for tick, state in run.states.items()}
    tips = {tick: of[0][:2] if way == "x" else of[0][1::-1] for tick, of in run.tips.items()}
    measures = measure(states[0], states[ticks], layer, 0.9 * length_m(scene) / 2, HALF_WIDTH_M)
    return Cut(name, layer, states, tips, scene["tools"][0]["hot_radius_m"],
               {"name": name, "length_mm": 1e3 * length_m(scene), **measures})


def run(sim, folder, quick):
    montage = Montage(len(DRAWN), 260, 205, 3500)
    cuts = at_once([lambda case=case: dissect(sim, *case) for case in (CASES[:2] if quick else CASES)])
    if not quick:
        for cut in cuts:
            for tick in (cut.last * k // STATES for k in DRAWN):
                cut.draw(montage, f"{cut.name}, {tick / STEPS_PER_S:.0f} s", tick)
        montage.write(f"{folder}/figure-7.svg")
    figures = {}
    for c in (cut.measures for cut in cuts):
        name = f"figure_7.{c['name'].replace(', ', '.')}"
        figures |= {f"{name}.strands": c["strands"], f"{name}.rough_mm": c["rough_mm"], f"{name}.open_mm": c["mean_mm"]}
    return figures, [cut.measures for cut in cuts]


def page(cuts):
    rows = ["| scene | strands across | roughness of the lips, mm | open: least, mean, most, mm | gone | charred |",
            "|---|---:|---:|---:|---:|---:|"]
    rows += [f"| {c['name']}, {c['length_mm']:.0f} mm | {c['strands']} | {c['rough_mm']:.2f} | {c['least_mm']:.1f}, "
             f"{c['mean_mm']:.1f}, {c['most_mm']:.1f} | {c['gone']} | {c['charred']} |" for c in cuts]
    return f"""## Figure 7: fascia and fat under the instrument

These pictures are drawn from the states that `cautery-sim` writes, as seen from above. (Pictures of the viewer follow
below.) The top layer has a border, openings are black, triangles with more than {CHARRED:.0%} of the dose at which they ignite are brown, and the hot part is a ring. The paper's scenes come first, without changes. Then follow two scenes with other
paths of the tool and an uneven ignition:

- *fascia, frayed*: the fibres lie across the cut. They ignite in bundles of 2 mm, at 160 degC on average, with the spread of the
  paper's table, 17 degC. The hook has a radius of 2 mm instead of 3 mm, and is drawn at 4 mm/s instead of 2 mm/s.
- *fat, frayed*: the fat is cut across its tension instead of along it, at 4 mm/s instead of 2 mm/s. The membrane is as
  taut as the fat (T = 0.3 along x). Membrane and fat ignite in bundles of 2 mm with the table's spreads, 4.1 and 2.9
  degC.

All other values are the paper's: temperatures, mean ignition, absorption, shrinkage, tension. The paper does not
state the tool's size, speed and path. These paths, the bundles' width and the seed were chosen from about fifty runs.
Another seed at the same setting left two strands instead of three.

![Four cuts, each at four times](figure-7.svg)

{chr(10).join(rows)}

A strand is a piece of tissue that joins both sides of a strip {2e3 * HALF_WIDTH_M:.0f} mm wide about the tool's path.
Roughness is the root mean square of a lip's distance from its own running mean over {1e3 * WINDOW_M:.0f} mm. Open is
the width of the gap without triangles, at {STATIONS} stations along the middle nine tenths of the cut, {REST_S} s after
the tool has passed. Removed and charred triangles are counted in the visible layer.

At 2 mm/s every bundle gets more heat than it withstands. The fascia opens as a smooth ellipse, the fat as a straight
trench. The spread of the paper's table alone changes little. With the shipped hook no strand stays at 2 to 3.5 mm/s.
With the thinner hook and a speed of 4 mm/s some bundles withstand their dose and stay across the cut. The last of these
bundles is at the end of the cut. Beside these strands the gap is narrower. Most of the roughness comes from the curves of the lips
between strands. The teeth of the lips are one or two cells long, 2 to 4 mm. A sheet of 6,000 triangles cannot have
finer teeth. The spread of the fat's ignition temperature is a quarter of the
fascia's spread. The fat parts completely, with uneven lips, at most one
strand, and more char; tension across the cut opens the cut.
"""
