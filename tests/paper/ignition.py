# SPDX-License-Identifier: GPL-3.0-or-later
"""Equation 20: when the first edge parts that lies wholly inside a hot tool."""

STEP_S = 1 / 60
CASES = (
    # scene, where the tool is held, what follows from the printed parameters: delta / (xi u)
    ("fascia", (0, 0, 0), 160 / (0.4 * 170)),
    ("fat", (0, 0, 0), 78 / (0.6 * 90)),
)


def held(scene, place):
    """Commands: the tool comes at 20 mm/s and stands still before it is energized."""
    tool = scene["tools"][0]
    start = tool["position_m"]
    ticks = 240
    for tick in range(3, ticks + 1, 3):
        at = [a + (b - a) * tick / ticks for a, b in zip(start, place)]
        yield {"command": "tool.move", "tick": tick, "tool": tool["name"], "position_m": at,
               "rotation": [1, 0, 0, 0], "jaw": 0}
    yield {"command": "tool.energize", "tick": ticks + 60, "tool": tool["name"], "energized": True}


def first_part_s(sim, name, place):
    """From the border where energy comes on to the end of the tick in which an edge parts."""
    scene = sim.scene(name)
    result = sim.run(scene, script=list(held(scene, place)), seconds=8).result
    return result["first_part_s"] - result["energized_s"] + STEP_S


def run(sim, _folder, _quick):
    found = {name: (expected, first_part_s(sim, name, place)) for name, place, expected in CASES}
    return {f"ignition.{name}_s": measured for name, (_, measured) in found.items()}, found


def page(found):
    rows = ["| scene | from eq. 20 | first edge parts after |", "|---|---:|---:|"]
    rows += [f"| `{name}` | {expected:.2f} s | {measured:.2f} s |" for name, (expected, measured) in found.items()]
    return f"""## Equation 20: ignition

The scene's tool is brought to the tissue, held still there, and energized. An edge that lies wholly inside the tool has
the tool's temperature u at both ends. So by eq. 20 the edge parts after delta / (xi u). The measured time may differ by a tick of 1/60 s.

{chr(10).join(rows)}
"""
