# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: balls that are pressed into a slab against the mesh's own solution and against Hertz, over meshes and as they
slide, how deep tissue is inside them, what a tool that is drawn costs, and whether anything crosses."""

import math
import re
import textwrap
from dataclasses import dataclass

import plots
from sim import at_once, printed, table

THICK_MM, YOUNG_MODULUS_PA = 16, 5000  # of paper_contact_probe's slab
POISSON, SLIDING_POISSON = 0.3, 0.4


@dataclass(frozen=True)
class Ball:
    """Radius, half width of its slab, depths, and that of them at which meshes are compared, all mm."""

    radius: float
    half: float
    depths: tuple
    usual: float

    def cell(self, cells):
        """Of a mesh in which the patch that it has by Hertz spans so many (mm)."""
        return 2 * math.sqrt(self.radius * self.usual) / cells


BALLS = (Ball(1.5, 8, (0.1, 0.2, 0.4, 0.8), 0.4), Ball(6.5, 24, (0.25, 0.5, 1, 2), 1), Ball(13, 26, (0.25, 0.5, 1, 2), 1),
         Ball(40, 40, (0.25, 0.5, 1, 2), 1))
SLIDING = BALLS[1]
SOLVED_CELLS = 4.5  # a patch, at the usual depth, where Newton's method solves the same mesh
MESHES, QUICK_MESHES = (2, 3, 4, 6, 8), (4, 6)
ENOUGH_CELLS = 4  # from which on meshes are asked to agree
SLIDES, QUICK_SLIDES = {2: 0.1, 4: 0.03, 6: 0.03}, (2, 4)  # cells a patch: the change that is asked for at most
SOLVED_SLIDES = (2, 4)
PLACES, SLIDING_PLACES = 4, 8  # along a cell
REST_CELLS_MM, REST_DEPTH_MM, REST_HALF_MM = (4, 2, 1), 2, 20
NARROW_HALF_MM, NARROW_CELL_MM = 8, 4  # a slab of few cells, in which the smallest ball rests on faces alone
MOST_ACROSS = 15  # cells a patch: more vertices of a finer mesh would touch than have rows
# Radius, depth (mm), speed (mm/s), and what is asked of the first.
COSTS, ASKED_MS, COST_TICKS = ((3, 2, 50), (6.5, 3, 50), (3, 2, 200)), 0.6, 200
EVERY, QUICK_EVERY = 3, 25  # of the presses of proxy_matrix_test.c without the finest slab: all speeds are among them
OF_SOLUTION, OVER_MESHES, OF_HERTZ, INSIDE_MM = 0.01, 0.1, 0.1, 0.1  # as asked

PRESS = re.compile(r"^(\S.*?) +(sheet|slab|layers) +(\S+) mm, +(\S+) m/s: (held|CROSSED), +\S+ N, (\S+) mm deep", re.MULTILINE)
TALLY = re.compile(r"^(\d+) of \d+ presses, (\d+) failed$", re.MULTILINE)


def pressed(sim, ball, cell, depths, places=1, solved=False, poisson=POISSON, half=None):
    numbers = (ball.radius, round(cell, 6), poisson, half or ball.half, places, int(solved), *depths)
    return table(sim, "paper_contact_probe", "press", *map(str, numbers))


def slid(sim, cells, solved):
    ball = SLIDING
    return pressed(sim, ball, ball.cell(cells), (ball.usual,), SLIDING_PLACES, solved, SLIDING_POISSON)


def rested(sim, ball, cell):
    return pressed(sim, ball, cell, (REST_DEPTH_MM,), PLACES, half=max(ball.half, REST_HALF_MM))


def narrow(sim):
    return pressed(sim, BALLS[0], NARROW_CELL_MM, (REST_DEPTH_MM,), PLACES, half=NARROW_HALF_MM)


def drawn(sim, case):
    return table(sim, "paper_contact_probe", "cost", *map(str, case), str(COST_TICKS))[0]


def read_matrix(text):
    """[(tool, tissue, cell in mm, whether it crossed, depth in mm)] and how many failed the test."""
    presses = [(tool, tissue, float(cell), crossed == "CROSSED", float(deep))
               for tool, tissue, cell, _, crossed, deep in PRESS.findall(text)]
    tally = TALLY.search(text)
    if not tally or int(tally[1]) != len(presses) or not presses:
        raise ValueError("the matrix of presses does not print all that it tried")
    return presses, int(tally[2])


def matrix(sim, every):
    return read_matrix(printed(sim, "test_core_session_proxy_matrix", check=False, environment={"PROXY_MATRIX": str(every)}))


def fits(ball, cell):
    return 2 * math.sqrt(ball.radius * REST_DEPTH_MM) / cell < MOST_ACROSS


def jobs_of(sim, quick):
    """{what: how it is made}, those that take longest first."""
    balls = BALLS[1:2] if quick else BALLS
    jobs = {"matrix": lambda: matrix(sim, QUICK_EVERY if quick else EVERY)}
    if not quick:
        jobs["narrow"] = lambda: narrow(sim)
    for ball in balls:
        depths = (ball.usual,) if quick else ball.depths
        jobs["depths", ball] = lambda ball=ball, depths=depths: pressed(sim, ball, ball.cell(SOLVED_CELLS), depths, solved=True)
    for cells in QUICK_SLIDES if quick else SLIDES:
        jobs["slides", cells] = lambda cells=cells: slid(sim, cells, cells in SOLVED_SLIDES and not quick)
    for ball in balls:
        for cells in QUICK_MESHES if quick else MESHES:
            jobs["meshes", ball, cells] = lambda ball=ball, cells=cells: pressed(sim, ball, ball.cell(cells), (ball.usual,), PLACES)
        for cell in REST_CELLS_MM[1:2] if quick else REST_CELLS_MM:
            if fits(ball, cell):
                jobs["rest", ball, cell] = lambda ball=ball, cell=cell: rested(sim, ball, cell)
    return jobs


def of_kind(found, kind):
    """{what it is of: its presses}"""
    return {key[1] if len(key) == 2 else key[1:]: rows for key, rows in found.items() if key[0] == kind}


def mean(values):
    return sum(values) / len(values)


def change(values):
    """From least to most, of the mean."""
    return (max(values) - min(values)) / mean(values)


def off(row, other):
    return row["force_n"] / row[other] - 1


def off_hertz(rows):
    return mean([off(row, "hertz_n") for row in rows])


def over_meshes(meshes, ball):
    """From least to most of Hertz's force, over all places on meshes that are fine enough."""
    values = [row["force_n"] / row["hertz_n"] for (of, cells), rows in meshes.items() if of == ball and cells >= ENOUGH_CELLS
              for row in rows]
    return max(values) / min(values) - 1


def wobble(rows):
    """How much the force changes while a ball rests, from least to most, of the mean of both, at the worst of its places."""
    return max((row["most_n"] - row["least_n"]) / max(abs(row["most_n"] + row["least_n"]) / 2, 1e-12) for row in rows)


def deepest(rows, what):
    return max(row[what] for row in rows)


def run(sim, folder, quick):
    costs = {} if quick else {case: drawn(sim, case) for case in COSTS}  # alone, as they are times
    jobs = jobs_of(sim, quick)
    found = dict(zip(jobs, at_once(list(jobs.values()))))
    meshes, rest = of_kind(found, "meshes"), of_kind(found, "rest")
    depths = [row for rows in of_kind(found, "depths").values() for row in rows]
    figures = {"contact.off_the_solution": max(abs(off(row, "solved_n")) for row in depths),
               "contact.off_hertz": max(abs(off_hertz(rows)) for (_, cells), rows in meshes.items() if cells >= ENOUGH_CELLS),
               "contact.over_meshes": max(over_meshes(meshes, ball) for ball, _ in meshes),
               **{f"contact.sliding.{cells}_cells": change([row["force_n"] for row in rows])
                  for cells, rows in of_kind(found, "slides").items()},
               "contact.vertices_inside_mm": 1e3 * max(deepest(rows, "vertex_depth_m") for rows in rest.values()),
               "contact.faces_inside_mm": max(1e3 * deepest(rows, "face_depth_m") for rows in rest.values()),
               "contact.crossed": sum(crossed for _, _, _, crossed, _ in found["matrix"][0])}
    if not quick:
        draw(folder, found)
    return figures, {"found": found, "costs": costs}


def hertz_line(ball, rows):
    """Hertz's force between the depths of a ball: a power of the depth from one to the next."""
    points = []
    for low, high in zip(rows, rows[1:]):
        power = math.log(high["hertz_n"] / low["hertz_n"]) / math.log(high["depth_m"] / low["depth_m"])
        points += [(1e3 * low["depth_m"] * s, 1e3 * low["hertz_n"] * s ** power)
                   for s in ((high["depth_m"] / low["depth_m"]) ** (k / 20) for k in range(21))]
    return points


def draw(folder, found):
    series = []
    for colour, (ball, rows) in enumerate(of_kind(found, "depths").items(), 1):
        series += [(f"{ball.radius:g} mm, Hertz", hertz_line(ball, rows), f"lines linecolor {colour}"),
                   ("session", in_mn(rows, "force_n"), f"points pointtype 7 pointsize 0.6 linecolor {colour}"),
                   ("the mesh's solution", in_mn(rows, "solved_n"), f"points pointtype 6 pointsize 1.2 linecolor {colour}")]
    plots.plot(plots.picture(folder, "contact-force"), f"Balls pressed into a slab of {THICK_MM} mm", "depth, mm", "force, mN", series,
               logscale="xy", extra=["set xrange [0.08:2.5]", "set yrange [0.2:400]"])
    meshes = of_kind(found, "meshes")
    plots.plot(plots.picture(folder, "contact-meshes"), "The same force by mesh", "cells a patch", "off Hertz, %",
               [(f"{ball.radius:g} mm", [(cells, 100 * off_hertz(meshes[ball, cells])) for cells in MESHES]) for ball in BALLS])
    slides = []
    for colour, (cells, rows) in enumerate(of_kind(found, "slides").items(), 1):
        for of, label, style in (("force_n", f"{cells} cells a patch", "linespoints pointtype 7 pointsize 0.6"),
                                 ("solved_n", "the mesh's solution", "points pointtype 6 pointsize 1.2")):
            if not math.isnan(rows[0][of]):
                middle = mean([row[of] for row in rows])
                slides.append((label, [(row["share"], 100 * (row[of] / middle - 1)) for row in rows], f"{style} linecolor {colour}"))
    plots.plot(plots.picture(folder, "contact-sliding"), f"A ball of {SLIDING.radius:g} mm somewhere else along a cell", "way, of a cell",
               "off the mean, %", slides)


def in_mn(rows, of):
    return [(1e3 * row["depth_m"], 1e3 * row[of]) for row in rows]


def paragraph(*sentences):
    return textwrap.fill(" ".join(sentences), 120, break_long_words=False, break_on_hyphens=False)


def judged(value, asked, form=".1%"):
    """What is said of a share, and of whether that is what is asked for."""
    return f"{value:{form}}, {'within' if value <= asked else 'above'} the {asked:.0%} that is asked"


def depth_rows(depths):
    return [f"| {ball.radius:g} | {1e3 * row['depth_m']:.3g} | {row['cells']:.1f} | {1e3 * row['force_n']:.4g} | "
            f"{1e3 * row['solved_n']:.4g} | {off(row, 'solved_n'):+.0e} | {1e3 * row['hertz_n']:.4g} | {off(row, 'hertz_n'):+.1%} |"
            for ball, rows in depths.items() for row in rows]


def mesh_rows(meshes):
    return [f"| {ball.radius:g} | {ball.usual:g} | "
            + " | ".join(f"{off_hertz(meshes[ball, cells]):+.1%}" for cells in MESHES)
            + f" | {over_meshes(meshes, ball):.1%} |" for ball in BALLS]


def slide_rows(slides):
    rows = []
    for cells, of in slides.items():
        solved = change([row["solved_n"] for row in of])
        moved = change([row["force_n"] for row in of])
        rows.append(f"| {cells} | {moved:.1%} | {'-' if math.isnan(solved) else f'{solved:.1%}'} | {SLIDES[cells]:.0%} | "
                    f"{'yes' if moved <= SLIDES[cells] else 'no'} |")
    return rows


def rest_rows(rest):
    rows = []
    for ball in BALLS:
        of = [rest.get((ball, cell)) for cell in REST_CELLS_MM]
        vertices = max(deepest(presses, "vertex_depth_m") for presses in of if presses)
        faces = " | ".join(f"{1e3 * deepest(presses, 'face_depth_m'):.2f}" if presses else "-" for presses in of)
        forces = " | ".join(f"{wobble(presses):.1%}" if presses else "-" for presses in of)
        rows.append(f"| {ball.radius:g} | {1e3 * vertices:.0e} | {faces} | {forces} |")
    return rows


def cost_rows(costs):
    return [f"| {radius:g} | {depth:g} | {speed:g} | {of['points']:.1f} | {of['in_ms']:.2f} | {of['away_ms']:.2f} | "
            f"{of['in_ms'] - of['away_ms']:.2f} |" for (radius, depth, speed), of in costs.items()]


def force_said(depths, meshes):
    rows = [row for of in depths.values() for row in of]
    solution = max(abs(off(row, "solved_n")) for row in rows)
    wide = [abs(off(row, "hertz_n")) for row in rows if row["cells"] >= ENOUGH_CELLS]
    few = [abs(off(row, "hertz_n")) for row in rows if row["cells"] < ENOUGH_CELLS]
    finest = max(abs(off_hertz(meshes[ball, MESHES[-1]])) for ball in BALLS)
    return paragraph(f"The force differs from the solution of the same mesh by at most {judged(solution, OF_SOLUTION, '.0e')}.",
                     f"The force differs from Hertz's force by at most {max(wide):.1%} if a patch spans {ENOUGH_CELLS} cells or more, "
                     f"and by at most {max(few):.1%} if a patch spans fewer.",
                     f"On the finest meshes of the next table the difference from Hertz is {judged(finest, OF_HERTZ)}.")


def meshes_said(meshes):
    most = max(over_meshes(meshes, ball) for ball in BALLS)
    return paragraph(f"Over meshes of {ENOUGH_CELLS} cells a patch and more, and all positions, the force changes by at most "
                     f"{judged(most, OVER_MESHES)}.")


def slides_said(slides):
    above = [cells for cells, rows in slides.items() if change([row["force_n"] for row in rows]) > SLIDES[cells]]
    if not above:
        return "All these ranges are within their limits."
    return paragraph(*(f"At {cells} cells a patch the range is above its limit"
                       + (f": the solution of such a mesh changes by {change([row['solved_n'] for row in slides[cells]]):.1%}."
                          if cells in SOLVED_SLIDES else ".") for cells in above))


def rest_said(rest):
    faces = {key: 1e3 * deepest(rows, "face_depth_m") for key, rows in rest.items()}
    vertices = 1e3 * max(deepest(rows, "vertex_depth_m") for rows in rest.values())
    above = [key for key in faces if faces[key] > INSIDE_MM]
    (ball, cell), deep = max(faces.items(), key=lambda item: item[1])
    faces_said = (f"Faces are deeper than the limit in {len(above)} of {len(faces)} cases, because a flat face dips into a "
                  "round ball" if above else "No face is deeper than the limit")
    without = [row["left_out"] > 0 for rows in rest.values() for row in rows]
    (restless, its_cell), most = max(((key, wobble(rows)) for key, rows in rest.items()), key=lambda item: item[1])
    return paragraph(f"The limit is {INSIDE_MM:g} mm. Vertices are inside by {vertices:.0e} mm at most, "
                     f"{'within' if vertices <= INSIDE_MM else 'above'} the limit.",
                     f"{faces_said}; the deepest face is {deep:.2f} mm deep (ball of {ball.radius:g} mm, cells of {cell:g} mm).",
                     f"At {sum(without)} of {len(without)} places touching tissue had no contact constraint." if any(without) else
                     "All touching tissue had its contact constraint.",
                     f"The force on a ball at rest changes by {most:.1%} at most (ball of {restless.radius:g} mm, cells of "
                     f"{its_cell:g} mm).", "A `-` means that more vertices would be in contact "
                     "than the capacity for contact constraints.")


def cost_said(costs):
    of = costs[COSTS[0]]
    more = of["in_ms"] - of["away_ms"]
    return (f"The first case may cost {ASKED_MS:g} ms at most. It costs {more:.2f} ms, {'within' if more <= ASKED_MS else 'above'} this limit.")


def crossing_said(presses, failed):
    crossed = sum(of[3] for of in presses)
    balls = [of for of in presses if of[0].startswith("ball")]
    above = [of for of in balls if of[4] > INSIDE_MM]
    tool, tissue, cell, _, deep = max(balls, key=lambda of: of[4])
    return paragraph(f"Of {len(presses)} presses **{crossed or 'none'}** crossed"
                     f"{'.' if failed == 0 else f', and {failed} failed the test that they are of.'}",
                     f"Of {len(balls)} balls {len(above) or 'none'} ended with a face deeper inside than {INSIDE_MM:g} mm; "
                     f"the deepest face is {deep:.2f} mm deep ({tool}, {tissue}, cells of {cell:g} mm).")


def narrow_said(rows):
    through = sum(row["least_n"] <= 0 for row in rows)  # what has let it through does not push it back
    return paragraph(f"One more case is not part of these presses. The ball of {BALLS[0].radius:g} mm without friction is pressed "
                     f"{REST_DEPTH_MM} mm deep into a slab {2 * NARROW_HALF_MM} mm wide with cells of {NARROW_CELL_MM} mm, at "
                     f"{len(rows)} places where it rests on faces.",
                     f"**The ball at rest passes through at {through} of them.**" if through else "The ball is held at all of them.")


def page(details):
    found, costs = details["found"], details["costs"]
    depths, meshes, slides, rest = (of_kind(found, kind) for kind in ("depths", "meshes", "slides", "rest"))
    return f"""## Contact of tools with tissue

    build/tests/paper_contact_probe press RADIUS_MM CELL_MM POISSON HALF_MM PLACES SOLVED DEPTH_MM...
    build/tests/paper_contact_probe cost RADIUS_MM DEPTH_MM SPEED_MM_S TICKS
    PROXY_MATRIX={EVERY} build/tests/test_core_session_proxy_matrix

Rigid balls without friction are pressed into a slab of {THICK_MM} mm that is bonded to its floor. The slab is stable
neo-Hookean with E {1e-3 * YOUNG_MODULUS_PA:g} kPa and nu {POISSON:g}. The session runs at an accuracy of 1e-4 until everything rests. Cells are
equal below the ball and grow outwards. "Cells a patch" is the number of cells along the diameter of the contact patch by
Hertz, 2 sqrt(R d). *Solution* is the force that Newton's method with an active set finds on the same mesh, in double
precision, without any code of core ([tests/reference](../reference/README.md)). *Hertz* is Hertz's force for small
strains, with the correction of Dimitriadis et al. (2002) for a thin layer.

| ball, mm | depth, mm | cells a patch | force, mN | solution, mN | off it | Hertz, mN | off it |
|---:|---:|---:|---:|---:|---:|---:|---:|
{chr(10).join(depth_rows(depths))}

{force_said(depths, meshes)}

![Force by depth](validation-contact-force.svg)

The next table has the difference from Hertz's force by mesh, as the mean of {PLACES} positions of the ball along a cell. The
last column is the range of the force over all these positions on meshes of {ENOUGH_CELLS} cells a patch and more.

| ball, mm | depth, mm | {' | '.join(f'{cells} cells' for cells in MESHES)} | least to most |
|---:|---:|{'---:|' * len(MESHES)}---:|
{chr(10).join(mesh_rows(meshes))}

{meshes_said(meshes)}

![Force by mesh](validation-contact-meshes.svg)

A ball of {SLIDING.radius:g} mm is pressed {SLIDING.usual:g} mm deep at {SLIDING_PLACES} positions along a cell, with nu {SLIDING_POISSON:g}. The table has the range
of the ball's force over these positions, relative to the mean.

| cells a patch | changes by | the mesh's solution by | asked | reached |
|---:|---:|---:|---:|---|
{chr(10).join(slide_rows(slides))}

{slides_said(slides)}

![Force along a cell](validation-contact-sliding.svg)

A ball rests {REST_DEPTH_MM} mm deep in a slab {2 * REST_HALF_MM} mm wide or more. The table has the largest depth of tissue
inside the ball, in mm, within half a second and over {PLACES} positions. One column has the depth of vertices on all meshes.
The next columns have the depth of faces, by the width of the cells. The last columns have the range of the force in
this half second, at the worst position.

| ball, mm | vertices | {' | '.join(f'faces, {cell} mm' for cell in REST_CELLS_MM)} | {' | '.join(f'force, {cell} mm' for cell in REST_CELLS_MM)} |
|---:|---:|{'---:|' * 2 * len(REST_CELLS_MM)}
{chr(10).join(rest_rows(rest))}

{rest_said(rest)}

A ball is drawn through `fat`. The table has the processor time of a step of ten iterations on one thread, with the ball
in the tissue and with a ball above it. Steps alternate; each mean is of {COST_TICKS} steps. "Vertices" is the number of
vertices that the ball touches.

| ball, mm | depth, mm | mm/s | vertices | with it, ms | without, ms | it costs, ms |
|---:|---:|---:|---:|---:|---:|---:|
{chr(10).join(cost_rows(costs))}

{cost_said(costs)}

Balls of 0.25 to 40 mm, a capsule, a hook and closed jaws are pressed into a taut sheet, a slab and `layers`. Their speed
is 0.01 to 1.5 m/s, the cells are 4, 2 and 1 mm wide, and the depth is five radii, but at most 4 mm. This page has every
third press, without the slab of 1 mm cells; `core_session_proxy_matrix_all` tries all presses. A tool has crossed if a face is above the tool, on the side from
which the tool came.

{crossing_said(*found["matrix"])}

{narrow_said(found["narrow"])}
"""
