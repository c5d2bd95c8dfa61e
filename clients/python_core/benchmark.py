#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
r"""Measures sessions in process beside cautery-sim, on the cut of the scene fascia.

    /usr/bin/python3 clients/python_core/benchmark.py --build build

Both take the same commands at the same ticks, and end with the same bits, or the benchmark fails. Runs alternate. Each
figure is a ratio to the run of cautery-sim beside it; the table has the median and the range. Nothing else should run.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(os.path.dirname(HERE), "python")]

TICKS = 480  # the way to the tissue, energy on, and the first of the cut
TICKS_A_STEP = 4
ENVIRONMENTS, THREADS = 16, 2
CUT_TICK = 420  # of a snapshot with a cut in it, from which resets are measured too
EPISODE_TICKS = 360


class Sim:
    """cautery-sim on the cut of fascia."""

    def __init__(self, build: str, scenes: str) -> None:
        self.scene = os.path.join(scenes, "fascia.json")
        self.command = [os.path.join(build, "bin/cautery-sim"), "--scene", self.scene]
        text = subprocess.run([*self.command, "--print-cut"], check=True, capture_output=True, text=True).stdout
        self.script: dict[int, list[dict[str, Any]]] = {}  # commands by tick
        for command in map(json.loads, text.splitlines()):
            self.script.setdefault(command["tick"], []).append(command)
        with open(self.scene, encoding="utf-8") as file:
            self.step_s = json.load(file).get("step_s", 1 / 60)

    def start(self) -> subprocess.Popen[str]:
        """A run of TICKS."""
        return subprocess.Popen([*self.command, "--cut", "--seconds", repr(TICKS * self.step_s), "--json"],
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    @staticmethod
    def finish(process: subprocess.Popen[str]) -> tuple[float, str]:
        """Ticks a second of its steps alone, and the hash of its end."""
        said = json.loads(process.communicate()[0].splitlines()[-1])
        assert said["ticks"] == TICKS, said
        return said["steps_per_s"], said["hash"]

    def play(self, session: Any, first: int, ticks: int) -> None:
        """The script's commands at their ticks, and the steps."""
        for tick in range(first, first + ticks):
            for command in self.script.get(tick, ()):
                session.submit(**command)
            session.step()


def make_environment(sim: Sim) -> Any:
    """A task that plays the cut: it needs no action, and shows how high the tissue is and how many faces are gone."""
    from cautery.environments import Box
    from cautery_core import Session

    class Cut:
        """Gymnasium's interface, as far as the vector uses it."""

        metadata: dict[str, Any] = {"render_modes": []}
        render_mode = None
        action_space, observation_space = Box([-1.0], [1.0]), Box([-10.0, 0.0], [10.0, 1e6])

        def __init__(self) -> None:
            self.session = Session(sim.scene)
            self.beginning, self.at = self.session.snapshot(), 0

        def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
            """Restores the beginning."""
            del seed, options
            self.session.restore(self.beginning)
            self.at = 0
            return self.observe(), {}

        def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
            """Goes on by TICKS_A_STEP."""
            del action
            sim.play(self.session, self.at, TICKS_A_STEP)
            self.at += TICKS_A_STEP
            return self.observe(), 0.0, False, self.at >= EPISODE_TICKS, {}

        def observe(self) -> Any:
            """Two numbers, of all positions and of the mask."""
            return np.array([self.session.positions[:, 2].max(), self.session.removed.sum()], np.float32)

        def close(self) -> None:
            """Ends the session."""
            self.session.close()
    return Cut


def measure_steps(sim: Sim, rounds: int) -> list[float]:
    """Ratios of ticks a second: here, with positions read at each, to cautery-sim's."""
    from cautery_core import Session
    ratios = []
    for _ in range(rounds):
        their_rate, their_hash = sim.finish(sim.start())
        with Session(sim.scene) as session:
            positions = session.positions
            begun_s = time.perf_counter()
            for tick in range(TICKS):
                sim.play(session, tick, 1)
                session.read_positions(positions)
            rate = TICKS / (time.perf_counter() - begun_s)
            assert f"{session.hash():016x}" == their_hash, "other bits than cautery-sim's"
        ratios.append(rate / their_rate)
        print(f"  {rate:.0f} ticks/s here, {their_rate:.0f} in cautery-sim", flush=True)
    return ratios


def measure_vector(sim: Sim, rounds: int) -> list[float]:
    """Ratios of ticks a second of all: environments on threads here, to as many processes of cautery-sim as threads."""
    from cautery.environments import VectorEnvironment
    ratios = []
    with VectorEnvironment([make_environment(sim)] * ENVIRONMENTS, THREADS) as vector:
        actions = np.zeros((ENVIRONMENTS, 1), np.float32)
        for _ in range(rounds):
            theirs = [sim.finish(process) for process in [sim.start() for _ in range(THREADS)]]
            vector.reset()
            begun_s = time.perf_counter()
            for _ in range(EPISODE_TICKS // TICKS_A_STEP):
                vector.step(actions)
            rate = ENVIRONMENTS * EPISODE_TICKS / (time.perf_counter() - begun_s)
            their_rate = sum(one for one, _ in theirs)
            ratios.append(rate / their_rate)
            print(f"  {rate:.0f} ticks/s here, {their_rate:.0f} in {THREADS} cautery-sim", flush=True)
    return ratios


def resident_bytes() -> int:
    """Memory of this process."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")


def measure_resets(sim: Sim, resets: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Seconds of each reset from just after the beginning, and from a cut; growth of memory over them, bytes."""
    from cautery_core import Session

    def timed(bytes_: bytes) -> float:
        begun_s = time.perf_counter()
        session.restore(bytes_)
        return time.perf_counter() - begun_s
    seconds: tuple[list[float], list[float]] = ([], [])
    with Session(sim.scene) as session:
        beginning = session.snapshot()
        sim.play(session, 0, CUT_TICK)
        cut = session.snapshot()
        grown_from = 0
        for i in range(resets // 20 + resets):
            if i == resets // 20:  # warm
                grown_from = resident_bytes()
            from_cut = i % 10 == 0
            if from_cut:
                session.restore(cut)
            session.step()
            seconds[from_cut].append(timed(beginning))
        return np.array(seconds[0]), np.array(seconds[1]), resident_bytes() - grown_from


def measure_episodes(sim: Sim, episodes: int) -> int:
    """How many episodes equal the first, in every bit of what they show, while cautery-sim loads all processors."""
    over = threading.Event()

    def load() -> None:
        while not over.is_set():
            sim.finish(sim.start())
    threads = [threading.Thread(target=load) for _ in range(os.cpu_count() or 1)]
    for thread in threads:
        thread.start()
    task, seen = make_environment(sim)(), []
    try:
        for _ in range(episodes):
            shown = [task.reset()[0]] + [task.step(None)[0] for _ in range(EPISODE_TICKS // TICKS_A_STEP)]
            seen.append((np.array(shown).tobytes(), task.session.positions.tobytes(), task.session.hash()))
    finally:
        over.set()
        task.close()
        for thread in threads:
            thread.join()
    return sum(one == seen[0] for one in seen)


def of_ratios(ratios: list[float]) -> str:
    """Median and range."""
    return f"{np.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f}, {len(ratios)} rounds)"


def of_seconds(seconds: np.ndarray) -> str:
    """Median, 99th percentile and most."""
    p50, p99, most = 1e3 * np.percentile(seconds, (50, 99, 100))
    return f"p50 {p50:.1f} ms, p99 {p99:.1f} ms, most {most:.1f} ms of {len(seconds)}"


def machine() -> str:
    """Its processor, and the load before the benchmark."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {os.cpu_count()} cores, load before it {os.getloadavg()[0]:.2f}"


def main() -> None:
    """Measures, and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default="build", help="the build tree")
    parser.add_argument("--scenes", default=os.path.join(HERE, "../../deploy/scenes"))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--resets", type=int, default=10000)
    parser.add_argument("--episodes", type=int, default=100)
    given = parser.parse_args()
    os.environ.setdefault("LIBCAUTERY_CORE", os.path.join(os.path.abspath(given.build), "deploy/libcautery-core.so"))
    about, sim = machine(), Sim(os.path.abspath(given.build), given.scenes)
    steps, vector = measure_steps(sim, given.rounds), measure_vector(sim, given.rounds)
    plain, cut, grown = measure_resets(sim, given.resets)
    equal = measure_episodes(sim, given.episodes)
    print(f"machine: {about}")
    print(f"steps, of cautery-sim's speed: {of_ratios(steps)}")
    print(f"{ENVIRONMENTS} environments on {THREADS} threads, of {THREADS} cautery-sim: {of_ratios(vector)}")
    print(f"reset: {of_seconds(plain)}")
    print(f"reset of a cut tissue: {of_seconds(cut)}")
    print(f"memory grew by {grown / 2**20:.1f} MiB over {given.resets} resets")
    print(f"{equal} of {given.episodes} episodes are equal to the bit under a load")
    if equal < given.episodes:
        sys.exit(1)


if __name__ == "__main__":
    main()
