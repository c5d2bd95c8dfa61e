# SPDX-License-Identifier: Apache-2.0
r"""Policies without learning that do the tasks: what a learner has to match, and what an action may look like.

    PYTHONPATH=clients/python /usr/bin/python3 clients/python/examples/scripted_policies.py \
        --daemon build/bin/cauteryd --scenes deploy/scenes
"""

from __future__ import annotations

import argparse
import itertools
from typing import Any, Iterator

import numpy as np

from cautery.environments import ClearPlane, SealAndDivide, Task
from cautery.environments import clear_plane as plane
from cautery.environments import seal_and_divide as strip

LANES_M = (-0.0055, -0.0018, 0.0018, 0.0055)  # of the hook's middle: its foot of 4 mm sweeps all strands in four
IN_FRONT_M, BEHIND_M = -0.0065, 0.0055  # of the plane
WIRE_M = 0.0009  # of the wire's middle over the lower sheet, which it burns at 0.7 mm


def clear(info: dict[str, Any], height_m: float = 0.007, wire_m: float = WIRE_M) -> Iterator[np.ndarray]:
    """Actions that clear the plane under traction of this height: from the free edge inwards, lane by lane.

    `wire_m`: height of the wire's middle over the lower sheet.
    """
    tip, height = info["tip_m"].copy(), plane.HEIGHT_FIRST_M

    def towards(x: float, y: float, hot: bool) -> Iterator[np.ndarray]:
        nonlocal height
        goal = np.array([x, y, wire_m - plane.GAP_M])
        while np.abs(goal - tip).max() > 1e-6 or abs(height_m - height) > 1e-6:
            move = ((goal - tip) / plane.MOVE_M).clip(-1, 1)
            lift = float(np.clip((height_m - height) / plane.MOVE_M, -1, 1))
            tip[:] = (tip + plane.MOVE_M * move).clip(plane.LEAST_M, plane.MOST_M)
            height += plane.MOVE_M * lift
            yield np.r_[move, lift, 1.0 if hot else -1.0]
    for x in LANES_M:
        yield from towards(x, IN_FRONT_M, False)
        yield from towards(x, BEHIND_M, True)
        yield from towards(x, IN_FRONT_M, False)


def seal(info: dict[str, Any], seals: int = 42, beside_m: float = 0.0) -> Iterator[np.ndarray]:
    """Actions that close the forceps, heat for so many steps, open, and draw the needle through beside their middle."""
    forceps, needle = info["forceps_m"], info["needle_m"]
    down = round((strip.FORCEPS_HIGH_M + 0.007) / strip.FORCEPS_MOVE_M)
    along = (forceps[0] + beside_m - needle[0]) / strip.NEEDLE_MOVE_M  # in steps

    def acts(count: int, lower: float = 0, closed: bool = False, hot: bool = False) -> Iterator[np.ndarray]:
        for _ in range(count):
            yield np.array([0, lower, 1 if closed else -1, 1 if hot else -1, 0, 0, -1], float)
    yield from acts(down, -1)
    yield from acts(6, closed=True)
    yield from acts(seals, closed=True, hot=True)
    yield from acts(2, closed=True)
    yield from acts(6)
    yield from acts(down, 1)
    while abs(along) > 1e-6:
        yield np.array([0, 0, -1, -1, np.clip(along, -1, 1), 0, -1])
        along -= np.clip(along, -1, 1)
    yield from draw_through()


def draw_through() -> Iterator[np.ndarray]:
    """Actions that draw the needle across the strip, and back 0.5 mm beside, until nothing is left between the parts."""
    crossing = round(2 * strip.NEEDLE_REACH_M / strip.NEEDLE_MOVE_M)
    for beside in itertools.cycle((1, -1, -1, 1)):
        for side in (1, -1):
            for _ in range(crossing):
                yield np.array([0, 0, -1, -1, 0, side, 1], float)
            if side == 1:
                yield np.array([0, 0, -1, -1, beside, 0, 1], float)


def divide(info: dict[str, Any]) -> Iterator[np.ndarray]:
    """Actions that divide the artery without a seal."""
    del info
    yield from draw_through()


def play(task: Task, seed: int, policy: Any) -> tuple[float, dict[str, Any], np.ndarray]:
    """An episode: the sum of its rewards, its last info, and what each step showed and gave."""
    observation, info = task.reset(seed=seed)
    seen = [np.r_[observation, 0.0]]
    for action in policy(info):
        observation, reward, terminated, truncated, info = task.step(action)
        seen.append(np.r_[observation, reward])
        if terminated or truncated:
            break
    steps = np.array(seen)
    return float(steps[:, -1].sum()), info, steps


def main() -> None:
    """Plays some episodes of both tasks."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--daemon", help="the cauteryd to start (default: the environment's CAUTERYD, or the path's)")
    parser.add_argument("--scenes", help="its folder of scenes, where it is not installed")
    parser.add_argument("--episodes", type=int, default=3)
    given = parser.parse_args()
    for kind, policy in ((ClearPlane, clear), (SealAndDivide, seal)):
        task = kind(daemon=given.daemon, **({"scenes": given.scenes} if given.scenes else {}))
        for seed in range(given.episodes):
            total, info, steps = play(task, seed, policy)
            print(f"{kind.__name__}, seed {seed}: {total:.1f} in {len(steps) - 1} steps, {info}")
        task.close()


if __name__ == "__main__":
    main()
