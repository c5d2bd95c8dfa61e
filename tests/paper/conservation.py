# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: what a free block keeps of momentum, angular momentum and energy, and where a swing's energy goes."""

import plots
from sim import table

ACCURACIES = (("as scenes come (1 %)", "0.01"), ("100 iterations", "0"))
RATES = (30, 60, 120, 240)  # steps a second of the swing


def flown(sim, accuracy):
    return table(sim, "paper_probe", "flight", accuracy)


def swung(sim, rate):
    """Its ticks, with what is left of the energy that rest at the end lacks, and what steps made out of nothing of it."""
    ticks = table(sim, "paper_probe", "swing", str(rate))
    total = [tick["kinetic_j"] + tick["elastic_j"] + tick["raised_j"] for tick in ticks]
    for tick, now in zip(ticks, total):
        tick["kept"] = 1 - now / total[-1]  # it was let go at 0
        tick["gained"] = tick["gained_j"] / -total[-1]
    return ticks


def run(sim, folder, quick):
    flights = {name: flown(sim, accuracy) for name, accuracy in (ACCURACIES[:1] if quick else ACCURACIES)}
    swings = {rate: swung(sim, rate) for rate in ((60,) if quick else RATES)}
    last = flights[ACCURACIES[0][0]][-1]
    figures = {"conservation.momentum_changed": last["momentum_changed"],
               "conservation.angular_changed": last["angular_changed"],
               "conservation.energy_kept": last["energy_kept"],
               "conservation.swing.gained": swings[60][-1]["gained"]}
    if not quick:
        draw(folder, flights, swings)
    return figures, {"flights": flights, "swings": swings}


def draw(folder, flights, swings):
    series = [(f"{what}, {name}", plots.thinned([(t["time_s"], t[of] - 1) for t in ticks]))
              for name, ticks in flights.items() for what, of in (("angular momentum", "angular_kept"),
                                                                  ("energy", "energy_kept"))]
    plots.plot(plots.picture(folder, "flight"), "A free block that moves and spins", "time, s", "gained or lost, of itself", series,
               extra=["set key below"])
    plots.plot(plots.picture(folder, "swing"), "Energy of a block that is released", "time, s",
               "left of what it had more than at rest",
               [(f"{rate} steps a second", plots.thinned([(t["time_s"], t["kept"]) for t in ticks]))
                for rate, ticks in swings.items()])


def page(found):
    flights = [f"| {name} | {ticks[-1]['momentum_changed']:.0e} | {ticks[-1]['angular_kept']:.4f} | "
               f"{ticks[-1]['angular_changed']:.1e} | {ticks[-1]['energy_kept']:.4f} |"
               for name, ticks in found["flights"].items()]
    swings = [f"| {rate} | {at(ticks, 0.5):.3f} | {at(ticks, 1):.3f} | {ticks[-1]['gained']:.0e} |"
              for rate, ticks in found["swings"].items()]
    return f"""## Momentum, angular momentum, energy

    build/tests/paper_probe flight ACCURACY
    build/tests/paper_probe swing STEPS_PER_S

A block of 40 x 40 x 20 mm without pins and weight starts at 0.11 m/s and spins at 10 rad/s about an
axis that is not one of its principal axes. The table compares momentum,
angular momentum and energy after ten seconds (600 steps) with their values at the start.

| steps | relative change of momentum | angular momentum along its first direction, end / start | relative change of angular momentum | energy, end / start |
|---|---:|---:|---:|---:|
{chr(10).join(flights)}

![Angular momentum and energy of a free block](validation-flight.svg)

A block of 80 x 20 x 20 mm, held at one end, is released in a level position and sinks. Nothing damps the block except
the method: implicit Euler removes energy from motion, and removes more with a longer step. The block's energy is its
kinetic, elastic and potential energy, minus the energy of the sunk block at rest. The table has the share of this
energy that is left. The last column is the energy that all steps added without a source.

| steps a second | after 0.5 s | after 1 s | added without a source |
|---:|---:|---:|---:|
{chr(10).join(swings)}

![Energy of a swing](validation-swing.svg)
"""


def at(ticks, time_s):
    return min(ticks, key=lambda tick: abs(tick["time_s"] - time_s))["kept"]
