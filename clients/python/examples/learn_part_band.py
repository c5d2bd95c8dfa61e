# SPDX-License-Identifier: Apache-2.0
r"""Learns to part a band of fascia and to burn nothing below, by the cross-entropy method.

The policy has four numbers. Each generation tries some of them, keeps the best, and draws the next around these. In the
end the best mean is tried on seeds that were not seen.

    PYTHONPATH=clients/python /usr/bin/python3 clients/python/examples/learn_part_band.py \
        --daemon build/bin/cauteryd --scenes deploy/scenes
"""

from __future__ import annotations

import argparse

import numpy as np

from cautery.environments import PartBand
from cautery.environments.part_band import COLUMNS, MOVE_M, REACH_M, WIDTH_M

# Of each number of the policy: its name, and where the first generation draws it.
NUMBERS = (("height of the tip while it cuts, mm", -3.0, 4.0), ("speed along the cut, share of the most", 0.05, 1.0),
           ("exposure of the sheet below at which energy rests", 0.0, 1.0), ("way beyond a column, mm", 0.0, 2.0))


EPISODES = 3  # of a policy in a generation
EDGE_M = WIDTH_M / 2 + 0.001  # beyond the band


class Policy:
    """Goes to the nearest column that still holds, at its height, hot once it is there; then over all of them again."""

    def __init__(self, numbers: np.ndarray, x_m: float) -> None:
        self.height_m, self.speed, self.rests, self.beyond_m = numbers * (1e-3, 1, 1, 1e-3)
        self.x_m = x_m
        self.side = 1.0

    def goal_m(self, tip: np.ndarray, parted: np.ndarray) -> float:
        """Where along the cut the tip goes next."""
        left = np.flatnonzero(parted < 0.5)
        if len(left):
            columns = ((left + 0.5) / COLUMNS - 0.5) * WIDTH_M
            y_m = columns[np.abs(columns - tip[1]).argmin()]
            return float(y_m + np.copysign(self.beyond_m, y_m - tip[1]))
        if self.side * tip[1] > EDGE_M - 0.5 * MOVE_M:
            self.side = -self.side
        return self.side * EDGE_M

    def act(self, observation: np.ndarray) -> np.ndarray:
        """The action."""
        tip = observation[:3] * np.array(REACH_M)
        away = np.array([self.x_m, self.goal_m(tip, observation[4:4 + COLUMNS]), self.height_m]) - tip
        there = abs(away[0]) < 2 * MOVE_M and abs(away[2]) < 2 * MOVE_M
        move = away / MOVE_M
        if there:
            move[1] = np.clip(move[1], -self.speed, self.speed)
        hot = there and observation[-1] <= self.rests
        return np.r_[move.clip(-1, 1), 1.0 if hot else -1.0].astype(np.float32)


def play(environment: PartBand, numbers: np.ndarray, seed: int) -> tuple[float, bool]:
    """The sum of rewards of an episode, and whether the band is parted and nothing below is burnt."""
    observation, info = environment.reset(seed=seed)
    policy, total, over = Policy(numbers, float(info["tip_m"][0])), 0.0, False
    while not over:
        observation, reward, terminated, truncated, info = environment.step(policy.act(observation))
        total += reward
        over = terminated or truncated
    return total, info["parted"] and not info["faces_burnt_below"]


def learn(environment: PartBand, generations: int, population: int, seed: int) -> np.ndarray:
    """The numbers of a policy."""
    random = np.random.default_rng(seed)
    low, high = np.array([bounds[1:] for bounds in NUMBERS]).T
    mean, spread = (low + high) / 2, (high - low) / 3
    for generation in range(generations):
        tried = random.normal(mean, spread, (population, len(NUMBERS))).clip(low, high)
        seeds = random.integers(1, 10_000, EPISODES).tolist()  # the same for all, so that chance favours none
        gained = []
        for numbers in tried:
            gained.append(float(np.mean([play(environment, numbers, seed)[0] for seed in seeds])))
            print(f"generation {generation + 1}, policy {len(gained)} of {population}: {gained[-1]:.1f}", flush=True)
        best = tried[np.argsort(gained)[-max(population // 4, 2):]]
        mean, spread = best.mean(axis=0), best.std(axis=0) + 0.02 * (high - low)
        print(f"generation {generation + 1} of {generations}: best {max(gained):.1f}, mean {np.mean(gained):.1f}", flush=True)
    return mean


def main() -> None:
    """Learns, and tries what was learnt."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--daemon", help="the cauteryd to start (default: the environment's CAUTERYD, or the path's)")
    parser.add_argument("--scenes", help="its folder of scenes, where it is not installed")
    parser.add_argument("--generations", type=int, default=8)
    parser.add_argument("--population", type=int, default=12)
    parser.add_argument("--trials", type=int, default=100, help="unseen seeds that the policy is tried on")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    environment = PartBand(daemon=given.daemon, **({"scenes": given.scenes} if given.scenes else {}))
    numbers = learn(environment, given.generations, given.population, given.seed)
    for (name, _, _), number in zip(NUMBERS, numbers):
        print(f"{name}: {number:.2f}")
    done = [play(environment, numbers, 100_000 + i)[1] for i in range(given.trials)]
    print(f"parted, and nothing below burnt, in {sum(done)} of {given.trials} unseen seeds")
    environment.close()


if __name__ == "__main__":
    main()
