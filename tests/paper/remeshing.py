# SPDX-License-Identifier: GPL-3.0-or-later
"""Section 7.1: the same cut by a method that changes the topology, beside ours, by cautery-bench."""

from costs import bench

SCENES = ("fascia", "fat")


def run(sim, _folder, quick):
    found = {scene: bench(sim, scene, 20, "--remesh")["remesh"] for scene in (SCENES[:1] if quick else SCENES)}
    figures = {}
    for scene, of in found.items():
        # What is counted is the same everywhere; of times, only which is longer.
        figures |= {f"remeshing.{scene}.{name}": of[name]
                    for name in ("changes", "vertices_added", "elements_added", "elements_removed")}
        figures[f"remeshing.{scene}.ours_moves_fewer_bytes"] = int(of["our_mask_bytes"] < of["buffer_bytes"])
    return figures, found


ROWS = (
    ("ticks in which something changed", lambda of: f"{of['changes']}", lambda of: f"{of['our_changes']}"),
    ("vertices added", lambda of: f"{of['vertices_added']}", lambda of: "0"),
    ("elements added, removed", lambda of: f"{of['elements_added']}, 0", lambda of: f"0, {of['elements_removed']}"),
    ("inserts and deletes in lists of neighbours", lambda of: f"{of['inserts']}, {of['deletes']}", lambda of: "0, 0"),
    ("edges parted: share counts lowered", lambda of: "-", lambda of: f"{of['edges_parted']}"),
    ("ill-shaped elements made", lambda of: f"{of['ill_shaped']}", lambda of: "0"),
    ("bytes of vertex and index buffers, masks", lambda of: f"{of['buffer_bytes']:,.0f}",
     lambda of: f"{of['our_mask_bytes']:,.0f}"),
    ("factors computed again, order and pattern with them", lambda of: f"{of['changes']}", lambda of: "0"),
    ("factors' numbers computed again, on another thread", lambda of: "-", lambda of: f"{of['refactorisations']}"),
    ("bytes of new systems and factors", lambda of: f"{of['system_bytes']:,.0f}", lambda of: "-"),
    ("mesh and neighbours, ms in all", lambda of: f"{1e3 * of['remesh_s']:.1f}", lambda of: "in the next line"),
    ("system and factor, ms in all", lambda of: f"{1e3 * (of['assemble_s'] + of['factor_s']):.0f}",
     lambda of: f"{1e3 * of['our_s']:.0f}"),
    ("a tick that changes something, ms", lambda of: f"{per_change(of):.2f}",
     lambda of: f"{1e3 * of['our_s'] / max(1, of['our_changes']):.2f}"),
)


def per_change(of):
    return 1e3 * (of["remesh_s"] + of["assemble_s"] + of["factor_s"]) / max(1, of["changes"])


def table(scene, of):
    lines = [f"| `{scene}`, {of['vertices']} vertices, {of['elements']} elements | re-meshed | ours |", "|---|---:|---:|"]
    return lines + [f"| {name} | {theirs(of)} | {ours(of)} |" for name, theirs, ours in ROWS] + [""]


def page(found):
    return f"""## Section 7.1: work and buffers of a cut

This section compares two ways to make the cut of a scene, in one run: our method, and a method that changes the
topology of the mesh. This other method ([tests/bench/remesh.c](../bench/remesh.c)) follows the tip with an upright
plane. It bisects the edges that the plane crosses, in all elements around each such edge. It duplicates the vertices in
the plane behind the tip, and connects the elements of one side to the duplicates. In each tick in which the mesh
changed, the other method assembles, orders, analyses and factors its linear system again. It also writes its buffers
again (12 bytes a vertex, 4 for each corner of an element).

{chr(10).join(line for scene, of in found.items() for line in table(scene, of))}
Four simplifications flatter the other method. Its cut has no width. Its system has only the elements of the cut layer,
without membrane, links or pins. It does not collapse or smooth ill-shaped elements. Ticks without a change are free.
One simplification flatters our method: the time of the numeric factorisation in another thread is not included. The
time of our method includes all ticks of the cut, with or without a change. Where vertices lie in the plane, the other
method need not bisect edges. So it only opens a sheet that has vertices on the line of cut. In the paper's terms, the
other method's inserts and deletes of buffers cost O(ins) and O(del), and its inserts and deletes of
neighbours cost O(N_ins) and O(N_del). In
the other method bisection costs O(re), and the test for ill-shaped elements O(ill). Our method only updates the share
counts, which costs O(n) at most.
"""
