# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections 7.2 and 7.3: what a cut costs the linear system, and frames a second, by cautery-bench."""

import json
import os
import subprocess

SCENES = (("fascia", 103.2), ("fat", 15.1))  # and the paper's frames a second


def bench(sim, scene, steps, *options):
    program = os.path.join(os.path.dirname(sim.program), "cautery-bench")
    command = [program, "--scene", scene, "--steps", str(steps), "--json", *options]
    answer = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(answer.stdout.splitlines()[-1])


def run(sim, _folder, quick):
    steps = 20 if quick else 300
    found = {}
    for scene, theirs in SCENES:
        one = bench(sim, scene, steps, "--update")
        two = None if quick else bench(sim, scene, steps, "--threads", "2")
        found[scene] = {"theirs": theirs, "one": one, "two": two}
    # Times are no figures to expect; what they are to each other is.
    figures = {}
    for scene, of in found.items():
        first = of["one"]["update"][0]
        figures[f"costs.{scene}.downdate_is_cheapest"] = int(first["downdate_ms"] < first["refactor_ms"])
        figures[f"costs.{scene}.order_costs_most"] = int(first["refactor_ms"] < first["anew_ms"])
    return figures, found


def update_rows(scene, rows):
    return [f"| `{scene}` | {row['elements']} | {row['downdate_ms']:.2f} | {row['refactor_ms']:.1f} | "
            f"{row['anew_ms']:.1f} | {row['anew_ms'] / min(row['downdate_ms'], row['refactor_ms']):.0f} |"
            for row in rows]


def frame_rows(found):
    return [f"| `{scene}` | {of['one']['triangles']} / {of['one']['tetrahedra']} | {of['theirs']} | "
            f"{of['one']['steps_per_s']:.0f} | {of['two']['steps_per_s']:.0f} |" for scene, of in found.items()]


def page(found):
    if any(of["two"] is None for of in found.values()):
        return ""
    updates = [line for scene, of in found.items() for line in update_rows(scene, of["one"]["update"])]
    machine = found["fat"]["one"]["machine"]
    return f"""## Section 7.2: what a cut costs the linear system

The elements nearest to the scene's line of cut are removed from A in three ways. The time of each way is measured until
the next solve can begin:

- exact downdates of the factor (rank 8), as a tick does when few elements are removed;
- factoring the numbers again with the same pattern, as a background thread does when many elements are removed;
- ordering, analysing and factoring again, as needed by a method whose cuts add vertices.

The time of the third way does not include re-meshing, so the last column flatters this way. Times are in ms on one
thread. Each time is the least of five.

| scene | elements | downdates | numbers again | order, pattern and numbers again | times the cheaper of ours |
|---|---:|---:|---:|---:|---:|
{chr(10).join(updates)}

## Section 7.3: frames a second

The table compares the paper's frames a second with our steps a second. The paper does not name its machine. Our steps
have ten iterations each, with contact and a hot tool, and without drawing.

| scene | triangles / tetrahedra | theirs | one thread | two threads |
|---|---:|---:|---:|---:|
{chr(10).join(frame_rows(found))}

Our steps were measured with `cautery-bench` on {machine['name']}, family {machine['family']} model {machine['model']},
{machine['instruction_set']}; the machine's load before was {machine['load_before']:.1f}. How long steps take in general
is in [tests/bench](../bench/README.md).
"""
