# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: the heat grid against closed forms, a spreading Gaussian and a ball that is held hot."""

import math
import re

import plots
from sim import printed, table

GAUSSIAN = re.compile(r"(\S+) at (\S+) mm")
BALL_M, AMBIENT_C, HOT_C, DIFFUSIVITY_M2_S = 0.003, 37, 170, 4.2e-6
# Spacing (mm) and nodes along an axis: as tools have it by default, then 32 mm wide, finer and finer.
GRIDS = ((1, 16), (1, 32), (0.75, 43), (0.5, 64))
SECONDS = (1, 3, 10)
REACH_M = 0.012  # as far as errors are looked at


def exact_c(distance_m, time_s):
    """Temperature about a ball whose surface is held hot from time 0 on, in an infinite medium."""
    if distance_m <= BALL_M:
        return HOT_C
    late = math.erfc((distance_m - BALL_M) / (2 * math.sqrt(DIFFUSIVITY_M2_S * time_s)))
    return AMBIENT_C + (HOT_C - AMBIENT_C) * BALL_M / distance_m * late


def spread(sim):
    """[(spacing in mm, largest error)] of the test that has a Gaussian spread."""
    lines = [line for line in printed(sim, "test_core_heat_heat_grid").splitlines() if line.startswith("gaussian:")]
    found = [(float(step), float(error)) for line in lines for error, step in GAUSSIAN.findall(line)]
    if not found:
        raise ValueError("the test of the heat grid does not print its Gaussian")
    return found


def about_a_ball(sim, grid):
    """{time: [(distance, temperature)]}, nearest first."""
    rows = {}
    for row in table(sim, "paper_probe", "heat", *map(str, grid)):
        if row["distance_m"] <= REACH_M:
            rows.setdefault(row["time_s"], []).append((row["distance_m"], row["temperature_c"]))
    return {time: sorted(of) for time, of in rows.items()}


def worst(points, time_s):
    """Largest error outside the ball, of tool minus ambient."""
    return max(abs(u - exact_c(r, time_s)) for r, u in points if r > BALL_M) / (HOT_C - AMBIENT_C)


def run(sim, folder, quick):
    gaussian = spread(sim)
    balls = {grid: about_a_ball(sim, grid) for grid in (GRIDS[-1:] if quick else GRIDS)}
    figures = {f"heat.gaussian.at_{step:g}_mm": error for step, error in gaussian}
    for (step, nodes), of in balls.items():
        figures[f"heat.ball.{step:g}_mm_{nodes}.off_at_1_s"] = worst(of[1], 1)
    if not quick:
        draw(folder, balls)
    return figures, {"gaussian": gaussian, "balls": balls}


def draw(folder, balls):
    for time in (SECONDS[0], SECONDS[-1]):
        mean = {}
        for grid, of in balls.items():
            by_distance = {}
            for r, u in of[time]:
                by_distance.setdefault(round(r, 7), []).append(u - exact_c(r, time))
            mean[grid] = [(1e3 * r, sum(errors) / len(errors)) for r, errors in sorted(by_distance.items())]
        plots.plot(plots.picture(folder, f"heat-{time}-s"), f"Off the closed form after {time} s", "distance from the ball's middle, mm",
                   "degC", [(f"{step:g} mm, {nodes} nodes", mean[step, nodes]) for step, nodes in balls])


def page(found):
    rows = [f"| {step:g} mm, {nodes} nodes | {' | '.join(f'{worst(of[time], time):.1%}' for time in SECONDS)} |"
            for (step, nodes), of in found["balls"].items()]
    gaussian = [f"| {step:g} mm | {error:.2%} |" for step, error in found["gaussian"]]
    return f"""## Heat

    build/tests/test_core_heat_heat_grid
    build/tests/paper_probe heat STEP_MM NODES

The test begins with the temperatures of a point source that has spread for a second. The heat spreads further in the
grid, and no node has a fixed temperature. The table has the largest error of a node, relative to the peak of the exact
solution.

| spacing | off |
|---|---:|
{chr(10).join(gaussian)}

A ball of radius R = {1e3 * BALL_M:g} mm is held at {HOT_C} degC from the beginning, in tissue of {AMBIENT_C} degC. In an infinite medium the exact
rise of temperature at a distance r from the ball's middle is R / r erfc((r - R) / (2 sqrt(alpha t))), as a share of
tool minus ambient ({HOT_C - AMBIENT_C} degC). The error is read at vertices of a strip of tissue through the ball, 0.25 mm apart, up to
a distance of {1e3 * REACH_M:g} mm. The table has the largest error outside the ball, also as a share of tool minus ambient. The first
line of the table is the default grid of tools.

| grid | after 1 s | 3 s | 10 s |
|---|---:|---:|---:|
{chr(10).join(rows)}

The next two plots have the error by distance from the ball. An error above zero means that the grid is too warm. Each
error is the mean of both sides of the ball.

![Error by distance after 1 s](validation-heat-1-s.svg)

![Error by distance after 10 s](validation-heat-10-s.svg)
"""
