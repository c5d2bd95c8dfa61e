# SPDX-License-Identifier: GPL-3.0-or-later
"""Which machine cautery-bench ran on, and whether two runs ran on the same."""

# What stays the same from run to run. The present clock is none of it: it moves.
IDENTITY = ("vendor", "name", "family", "model", "stepping", "mhz_most", "cores", "caches", "instruction_set")
# Beyond these the figures say as much of the other programs as of this one.
OTHERS_MOST, STEAL_MOST = 0.05, 0.02


def differences(a, b):
    """Words for what tells two `machine` objects apart; empty: nothing does."""
    return [f"{name}: {a.get(name)} and {b.get(name)}" for name in IDENTITY if a.get(name) != b.get(name)]


def unknown(machine):
    """True if it says too little to be told from another one."""
    return machine.get("model") is None and machine.get("name") is None


def check(machines):
    """Raises ValueError unless all are one machine, which can be told from others."""
    first = machines[0]
    for other in machines[1:]:
        apart = differences(first, other)
        if apart:
            raise ValueError("runs of two machines: " + "; ".join(apart))


def bytes_text(count):
    return f"{count / 2**20:g} MiB" if count >= 2**20 else f"{count / 2**10:g} KiB"


def worst(machines, name):
    told = [machine[name] for machine in machines if machine.get(name) is not None]
    return max(told) if told else None


def share(value):
    return "unknown" if value is None else f"{100 * value:.1f} %"


def line(machines):
    """The page's line about the runs' one machine."""
    m = machines[0]
    parts = [m["name"] or "processor not named"]
    if m["vendor"]:
        parts[0] += f" ({m['vendor']})"
    parts += [f"{name} {m[name]}" for name in ("family", "model", "stepping") if m[name] is not None]
    clock = m["mhz_most"] or m["mhz_present"]
    parts.append("clock not told" if clock is None else f"{clock:.0f} MHz")
    parts.append(f"{m['cores']} cores")
    parts.append(", ".join(f"{name} {bytes_text(size)}" for name, size in m["caches"].items()) or "caches not told")
    parts.append(f"kernels for {m['instruction_set']}")
    load = worst(machines, "load_before")
    text = ", ".join(parts) + (
        f". Worst of {len(machines)} runs: load before it {'unknown' if load is None else f'{load:.2f}'}, "
        f"other programs {share(worst(machines, 'others'))} of the cores' time, "
        f"steal {share(worst(machines, 'steal'))}")
    if (worst(machines, "others") or 0) > OTHERS_MOST or (worst(machines, "steal") or 0) > STEAL_MOST:
        text += " (**the machine was not idle: compare nothing with these figures**)"
    return text
