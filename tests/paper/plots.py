# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots of the validation page, by gnuplot, in the style of tests/bench."""

import os
import subprocess


def plot(path, title, x_label, y_label, series, logscale="", extra=()):
    """Lines of [(label, [(x, y)])] as an SVG, or of [(label, [(x, y)], gnuplot's style)]; `logscale` of gnuplot's axes,
    `extra` lines of its own language."""
    blocks, clauses = [], []
    for index, (label, points, *own) in enumerate(series):
        blocks.append(f"$d{index} << END\n" + "\n".join(f"{x} {y}" for x, y in points) + "\nEND")
        style = own[0] if own else "linespoints" if len(points) < 50 else "lines"
        clauses.append(f'$d{index} with {style} linewidth 2 title "{label}"')
    script = "\n".join([
        'set terminal svg size 720,440 font "sans-serif,13" background "white"',
        f'set output "{path}"', f'set title "{title}"', f'set xlabel "{x_label}"', f'set ylabel "{y_label}"',
        f"set logscale {logscale}" if logscale else "", 'set grid', 'set key outside right',
        'set format y "%g"', 'set format x "%g"', *extra, *blocks, "plot " + ", ".join(clauses)])
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def picture(folder, name):
    return os.path.join(folder, f"validation-{name}.svg")


def thinned(points, most=200):
    """Every so-manieth point, and the last: a page is small."""
    every = -(-len(points) // most)
    return points[::every] + points[-1:] if every > 1 else points
