# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: the error of a step by iterations and time, for each scene, sheets that hang free among them."""

import json
import os
import tempfile

import plots
from costs import bench

PULLED = (("fascia", ()), ("fat", ()), ("fat-neohookean", ()), ("layers", ()), ("strain-xy-on", ()),
          ("strain-xy-on", ("--solver", "newton")))
SCENES = ("fascia", "fat", "fat-neohookean", "layers", "strain-xy-on", "strain-none-off")
STEPS, QUICK_STEPS = 60, 20
QUICK_SCENES = 4  # those that reach what is wanted
WANTED = 0.01
CONVERGED = 1e-3  # residual of a reference, of its first iteration's, from which on errors are not to be trusted


def hanging(stiffness_pa, solver):
    """A sheet of 60 mm that lies level, held along an edge, and is let go."""
    scene = {"name": f"hanging-{stiffness_pa / 1e6:g}-mpa", "damping_per_s": 2,
             "meshes": [{"name": "sheet", "source": "sheet", "size_m": [0.06, 0.06], "cells": [20, 20]}],
             "layers": [{"name": "sheet", "kind": "fascia", "mesh": "sheet", "limit_stiffness_pa": stiffness_pa}],
             "pins": [{"kind": "box", "least_m": [-1, 0.0299, -1], "most_m": [1, 1, 1]}]}
    if solver == "newton":
        scene |= {"solver": solver, "iterations": 60}
    if stiffness_pa > 1e6:
        scene["precision"] = "double"  # single precision rounds its stresses by 2 % of its weight
    return scene


def let_go(sim, stiffness_pa, solver, steps):
    scene = hanging(stiffness_pa, solver)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, f"{scene['name']}.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        return bench(sim, path, steps, "--accuracy", str(WANTED))


def run(sim, folder, quick):
    steps = QUICK_STEPS if quick else STEPS
    pulled = [(f"{scene}{', Newton' if options else ''}", bench(sim, scene, QUICK_STEPS, "--error", *options))
              for scene, options in (PULLED[:1] if quick else PULLED)]
    accurate = [(scene, bench(sim, scene, steps, "--accuracy", str(WANTED))) for scene in SCENES[:QUICK_SCENES if quick else None]]
    sheets = ((1e6, "newton"),) if quick else tuple((e, s) for e in (1e6, 1e7) for s in ("cholesky", "newton"))
    for stiffness_pa, solver in sheets:
        name = f"60 mm hanging, {stiffness_pa / 1e6:g} MPa{', Newton' if solver == 'newton' else ''}"
        accurate.append((name, let_go(sim, stiffness_pa, solver, steps)))
    figures = {"errors.fascia.at_10_iterations": pulled[0][1]["error_at_K"],
               **{f"errors.{scene}.p95": of["error_p95"] for scene, of in accurate[:QUICK_SCENES]},
               "errors.hanging_1_mpa_newton.p95": dict(accurate)["60 mm hanging, 1 MPa, Newton"]["error_p95"]}
    if not quick:
        draw(folder, pulled)
    return figures, {"pulled": pulled, "accurate": accurate}


def draw(folder, pulled):
    for name, label, member in (("error-by-iterations", "iterations", "iterations"), ("error-by-time", "time of a step, ms", "ms")):
        plots.plot(plots.picture(folder, name), "Error of a step, of its own motion", label, "error",
                   [(scene, [(point[member], max(point["error"], 1e-9)) for point in of["error_curve"]])
                    for scene, of in pulled], logscale="xy")


def percent(value):
    return f"{100 * value:.2g} %"


def pulled_rows(pulled):
    curve = [point["iterations"] for point in pulled[0][1]["error_curve"]]
    rows = [f"| scene | {' | '.join(str(k) for k in curve)} | iterations to 1 % | reference's residual |",
            "|---|" + "---:|" * (len(curve) + 2)]
    for scene, of in pulled:
        cells = " | ".join(percent(point["error"]) for point in of["error_curve"])
        reached = str(of["iterations_to_1pct"]) if of["iterations_to_1pct"] < 64 else "more than 63"
        rows.append(f"| {scene} | {cells} | {reached} | {of['reference_residual']:.0e} |")
    return rows


def not_to_be_trusted(pulled):
    names = [scene for scene, of in pulled if of["reference_residual"] > CONVERGED]
    return (f"The reference of {', '.join(names)} has not converged in a thousand iterations, so the errors in its lines mean little. " if names else "")


def page(found):
    accurate = [f"| {scene} | {percent(of['error_p95'])} | {of['iterations_mean']:.1f} | {of['speedup_over_k']:.2f} |"
                for scene, of in found["accurate"]]
    machine = found["pulled"][0][1]["machine"]
    return f"""## Error of a step by iterations and time

    build/bin/cautery-bench --scene NAME --steps {QUICK_STEPS} --error
    build/bin/cautery-bench --scene NAME --steps {STEPS} --accuracy {WANTED}

The table has the mean error of steps by their number of iterations, while the scene pulls on the tissue. The error is
the difference from the converged step from the same state, relative to the motion of this step. `strain-xy-on` is a
sheet that hangs free. One line has this sheet with the solver of all scenes, and one line with Newton's steps
(`solver: "newton"`).

{chr(10).join(pulled_rows(found["pulled"]))}

{not_to_be_trusted(found["pulled"])}After ten iterations a free sheet is still far from the solution, because the prefactored matrix A treats a sheet as
equally stiff across its plane and within its plane. Newton's steps come near the solution under the sheet's own weight
(next table). Under this pull, which takes the sheet to its strain limits, they come near the solution only slowly.

![Error by iterations](validation-error-by-iterations.svg)

![Error by time](validation-error-by-time.svg)

Times are medians on one thread, on {machine['name']}, family {machine['family']} model {machine['model']}. Other programs ran too: the load average was {machine['load_before']:.1f} before
the run, and they used {machine['others']:.0%} of the cores' time during the run. Compare the lines with each other, not with lines of
another machine.

The next table is of {STEPS} steps that end as soon as their estimated error is {WANTED:.0%} (after at most 40 iterations, also of
Newton's steps). The second column is the error that 95 % of the sampled steps do not exceed, over all vertices or over
the worst chunk of 256 vertices. The table also has the iterations, and the speed as a multiple of the speed with ten
iterations, from alternating runs. Tools are
where the scene puts them. A hanging sheet is first level and held along one edge, and is then released.

| scene | 95 % are off by less than | iterations | speed over ten iterations |
|---|---:|---:|---:|
{chr(10).join(accurate)}
"""
