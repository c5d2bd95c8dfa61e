#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures with cautery-bench and writes this folder's README.md and its two plots anew.

Usage: tests/bench/page.py [--program build/bin/cautery-bench] [--steps 300] [--keep FILE]
       tests/bench/page.py --from FILE...          writes the page from kept runs, merged
       tests/bench/page.py --compare BEFORE AFTER  kept runs side by side; writes nothing

Measuring takes about a quarter of an hour. Run it on a machine that does nothing else. Needs gnuplot for the
plots. Runs of two machines are neither merged nor compared.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys

import machine

FOLDER = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(FOLDER))
SCENES = ("fascia", "fat", "fat-neohookean", "layers")
PULLED = ("fascia", "fat", "fat-neohookean")
STAGES = ("predict", "local", "global", "contact", "heat", "dissect", "frame")


class Bench:
    """Measures, and keeps what it has measured."""

    def __init__(self, program, steps):
        self.program, self.steps, self.runs = program, steps, []

    def run(self, scene, threads=1, solver=None, *options):
        command = ["--scene", scene, "--threads", str(threads), "--steps", str(self.steps), "--json", *options]
        command += ["--solver", solver] if solver else []
        print(" ".join(command), file=sys.stderr)
        answer = subprocess.run([self.program, *command], check=True, stdout=subprocess.PIPE, text=True)
        result = json.loads(answer.stdout.splitlines()[-1])
        self.runs.append({"arguments": [scene, threads, solver, *options], "result": result})
        return result

    def machines(self):
        return [run["result"]["machine"] for run in self.runs]

    def keep(self, name):
        with open(name, "w", encoding="utf-8") as file:
            json.dump({"steps": self.steps, "runs": self.runs}, file, indent=1)


class Kept(Bench):
    """Gives what an earlier Bench has kept, in the order in which it was measured."""

    def __init__(self, name):
        with open(name, encoding="utf-8") as file:
            kept = json.load(file)
        super().__init__(None, kept["steps"])
        self.name, self.runs, self.left = name, kept["runs"], list(kept["runs"])

    def run(self, *arguments):
        wanted = [*arguments, *(1, None)[len(arguments) - 1:]]
        for run in self.left:
            if run["arguments"] == wanted:
                self.left.remove(run)
                return run["result"]
        raise ValueError(f"{self.name} has no run of {wanted}")


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def ms(value):
    return f"{value:.3f}" if value < 10 else f"{value:.1f}"


def percent(value):
    return f"{100 * value:.2g} %"


def step_round(bench):
    return {(scene, threads): bench.run(scene, threads) for scene in SCENES for threads in (1, 2)}


# Of each row the round with the least median: a shared machine slows down for minutes.
def step_table(rounds):
    head = ["scene", "T", "steps/s", "median", "p99", *STAGES, "limit", "x K solves", "MiB", "allocations"]
    rows = []
    for scene in SCENES:
        for threads in (1, 2):
            r = min((results[scene, threads] for results in rounds), key=lambda r: r["ms_median"])
            rows.append([f"`{scene}`", str(threads), f"{r['steps_per_s']:.0f}", ms(r["ms_median"]),
                         ms(r["ms_p99"]), *(ms(r["stages"][s]) for s in STAGES), ms(r["limit_ms"]),
                         f"{r['frame_over_cholmod']:.2f}", f"{r['bytes_session'] / 2**20:.0f}",
                         f"{r['allocations_per_step']:g}"])
    return table(head, rows), r["bandwidth_b_s"]


def error_table(bench):
    head = ["scene", "system", "error at K = 10", "worst", "iterations to 1 %", "ms to 1 %",
            "reference's residual"]
    rows, curves = [], []
    for solver, scenes in (("cholesky", PULLED), ("diagonal", ("fascia", "fat"))):
        for scene in scenes:
            r = bench.run(scene, 1, solver, "--error")
            curves.append((f"{scene}, {solver}", r["error_curve"]))
            reached = r["iterations_to_1pct"] < 64
            rows.append([f"`{scene}`", solver, percent(r["error_at_K"]), percent(r["error_max"]),
                         str(r["iterations_to_1pct"]) if reached else "more than 63",
                         ms(r["ms_to_1pct"]) if reached else "-",
                         f"{r['reference_residual']:.0e}"])
    return table(head, rows), curves


def cut_round(bench):
    return {(scene, threads): bench.run(scene, threads, None, "--cut", "--repeat", "5")
            for scene in PULLED for threads in (1, 2)}


# Of each row the round whose plain steps had the least to wait for, whatever its ratio.
def cut_table(rounds):
    head = ["scene", "T", "plain median", "plain p99", "cutting p99", "ratio", "elements removed", "cutting steps",
            "new factors", "longest wait"]
    rows = []
    for scene in PULLED:
        for threads in (1, 2):
            r = min((results[scene, threads] for results in rounds), key=lambda r: r["plain_p99_ms"])
            rows.append([f"`{scene}`", str(threads), ms(r["plain_ms"]), ms(r["plain_p99_ms"]),
                         ms(r["cut_p99_ms"]),
                         f"{r['cut_p99_over_plain']:.2f}", str(r["elements_removed"]),
                         str(r["cutting_steps"]), str(r["refactorisations"]),
                         f"{1e3 * r['deferred_max_s']:.0f} ms"])
    return table(head, rows)


def scaling_table(bench):
    head = ["scene", "elements and ms", "exponent"]
    rows, sizes = [], []
    for scene in ("fat", "fat-neohookean"):
        r = bench.run(scene, 1, None, "--scaling", "--repeat", "3")
        sizes.append((scene, r["scaling"]))
        points = ", ".join(f"{p['elements']}: {ms(p['ms'])}" for p in r["scaling"])
        rows.append([f"`{scene}`", points, f"{r['scaling_exponent']:.2f}"])
    return table(head, rows), sizes


def plot(name, title, x_label, y_label, series):
    """A log-log plot of [(label, [(x, y)])] as FOLDER/name."""
    blocks, clauses = [], []
    for index, (label, points) in enumerate(series):
        blocks.append(f"$d{index} << END\n" + "\n".join(f"{x} {y}" for x, y in points) + "\nEND")
        clauses.append(f'$d{index} with linespoints linewidth 2 title "{label}"')
    script = "\n".join([
        'set terminal svg size 720,440 font "sans-serif,13" background "white"',
        f'set output "{os.path.join(FOLDER, name)}"',
        f'set title "{title}"', f'set xlabel "{x_label}"', f'set ylabel "{y_label}"',
        'set logscale xy', 'set grid', 'set key outside right', 'set format y "%g"',
        'set format x "%g"', *blocks, "plot " + ", ".join(clauses)])
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def measure(bench):
    """Three rounds of what is measured in rounds, some minutes apart."""
    step_rounds, cut_rounds = [step_round(bench)], [cut_round(bench)]
    errors = error_table(bench)
    step_rounds.append(step_round(bench))
    cut_rounds.append(cut_round(bench))
    scaling = scaling_table(bench)
    step_rounds.append(step_round(bench))
    cut_rounds.append(cut_round(bench))
    return step_rounds, cut_rounds, errors, scaling


def check_machines(benches):
    """Raises ValueError unless all runs are of one machine."""
    machines = [one for bench in benches for one in bench.machines()]
    machine.check(machines)
    if len(benches) > 1 and machine.unknown(machines[0]):
        raise ValueError("these runs do not say which machine they are of")
    return machines


def compare(before, after):
    """Medians side by side, the least of each row's rounds."""
    check_machines([before, after])
    medians = []
    for bench in (before, after):
        best = {}
        for run in bench.runs:
            scene, threads, solver, *options = run["arguments"]
            if not options and not solver:
                row = (scene, threads)
                best[row] = min(best.get(row, float("inf")), run["result"]["ms_median"])
        medians.append(best)
    rows = [[f"`{scene}`", str(threads), ms(old), ms(medians[1][scene, threads]),
             f"{medians[1][scene, threads] / old:.2f}"]
            for (scene, threads), old in medians[0].items() if (scene, threads) in medians[1]]
    return table(["scene", "T", "before", "after", "ratio"], rows)


def write_page(benches):
    measured = [measure(bench) for bench in benches]
    machines = check_machines(benches)
    steps, bandwidth = step_table([one for rounds, _, _, _ in measured for one in rounds])
    cuts = cut_table([one for _, rounds, _, _ in measured for one in rounds])
    (errors, curves), (scaling, sizes) = measured[-1][2:]
    plot("error-against-time.svg", "Error of a step against its time, one core", "ms", "error",
         [(label, [(p["ms"], p["error"]) for p in curve]) for label, curve in curves])
    plot("time-against-size.svg", "Time of a step against size, one core", "tetrahedra", "ms",
         [(label, [(p["elements"], p["ms"]) for p in points]) for label, points in sizes])
    with open(os.path.join(FOLDER, "page.md.in"), encoding="utf-8") as file:
        page = file.read()
    values = {"machine": machine.line(machines), "steps": steps, "errors": errors, "cuts": cuts,
              "scaling": scaling, "bandwidth": f"{bandwidth / 1e9:.0f}"}
    for name, value in values.items():
        page = page.replace(f"@{name}@", value)
    with open(os.path.join(FOLDER, "README.md"), "w", encoding="utf-8") as file:
        file.write(page)


def read_arguments():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--program", default=os.path.join(ROOT, "build/bin/cautery-bench"))
    arguments.add_argument("--steps", type=int, default=300)
    arguments.add_argument("--keep", metavar="FILE", help="write every run there as well")
    arguments.add_argument("--from", dest="kept", nargs="+", metavar="FILE", help="measure nothing: merge kept runs")
    arguments.add_argument("--compare", nargs=2, metavar=("BEFORE", "AFTER"), help="kept runs side by side")
    return arguments.parse_args()


def main():
    options = read_arguments()
    if options.compare:
        print(compare(*(Kept(name) for name in options.compare)))
        return
    if not shutil.which("gnuplot"):
        sys.exit("page.py: gnuplot is missing: apt-get install gnuplot-nox")
    if options.kept:
        benches = [Kept(name) for name in options.kept]
        check_machines(benches)
        write_page(benches)
        return
    if not os.path.exists(options.program):
        sys.exit(f"page.py: {options.program} is missing: build the release preset first")
    bench = Bench(options.program, options.steps)
    write_page([bench])
    if options.keep:
        bench.keep(options.keep)


if __name__ == "__main__":
    try:
        main()
    except ValueError as error:
        sys.exit(f"page.py: {error}")
