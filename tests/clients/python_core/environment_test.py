# SPDX-License-Identifier: GPL-3.0-or-later
"""The tasks for learners in this process. PYTHONPATH has both packages, the examples and tests/clients/e2e; PROGRAMS and
SCENES are as in programs.py."""

import os
import re
import threading
import unittest
from unittest import mock

import numpy as np

import cautery.environments
import cautery_core
from cautery.environments import VectorEnvironment, check_environment, check_vector_environment
from cautery_core.environments import CoreTissue, PartBand

import learn_part_band
import programs

PACKAGE = os.path.dirname(os.path.dirname(cautery_core.__file__))
# Numbers of a policy that parts the band: the tip in it, slowly, whatever the sheet below has taken up.
KNOWN = np.array([0.2, 0.6, 0.5, 1.0])
STEPS = 20  # of an episode: the tip is in the band after ten
SEEDS = (1, 3)  # of two, these draw one tissue each
COUNT = 3
RESETS = 400
GROWTH_BYTES = 4 << 20  # a leak of one array of positions in each reset would be twice that


def play(task, seed):
    """What an episode showed and gave, (steps, observation and reward)."""
    observation, info = task.reset(seed=seed)
    policy, seen, over = learn_part_band.Policy(KNOWN, info["tip_m"][0]), [np.r_[observation, 0]], False
    while not over:
        observation, reward, terminated, truncated, _ = task.step(policy.act(seen[-1][:-1]))
        seen.append(np.r_[observation, reward])
        over = terminated or truncated
    return np.array(seen)


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")


class Task(unittest.TestCase):
    def task(self, **how):
        made = PartBand(steps_most=STEPS, **how)
        self.addCleanup(made.close)
        return made

    def test_it_keeps_the_rules_of_the_interface(self):
        self.assertEqual(check_environment(self.task(render_mode="rgb_array")), [])

    def test_episodes_are_those_of_a_daemon_to_the_bit(self):
        daemon = cautery.environments.PartBand(daemon=os.path.join(programs.PROGRAMS, "cauteryd"), steps_most=STEPS,
                                               scenes=os.environ["SCENES"])
        self.addCleanup(daemon.close)
        here = self.task()
        for seed in SEEDS:
            one, other = play(daemon, seed), play(here, seed)
            self.assertTrue(np.array_equal(one, other), f"seed {seed}")
            self.assertGreater(one[-1, 16], 0.1)  # exposure of the band

    def test_a_reset_restores_where_the_tissue_is_one_of_few(self):
        built = []

        def count(*arguments, **named):
            built.append(arguments)
            return cautery_core.Session(*arguments, **named)
        with mock.patch("cautery_core.environments.Session", count):
            task = self.task(tissue_count=2)
            first = [play(task, seed) for seed in SEEDS]
            again = [play(task, seed) for seed in SEEDS]
            self.assertEqual(len(built), 2)
            self.assertTrue(all(np.array_equal(one, other) for one, other in zip(first, again)))
            fresh = self.task(tissue_count=2)
            self.assertTrue(np.array_equal(play(fresh, SEEDS[-1]), first[-1]))
            small = self.task(tissue_count=2, kept=1)
            self.assertTrue(np.array_equal(play(small, SEEDS[0]), first[0]))

    def test_episodes_are_equal_under_a_load(self):
        """The load: as many threads as the machine has processors, each with a tissue of its own."""
        task, over = self.task(tissue_count=1), threading.Event()

        def load():
            with cautery_core.Session(os.path.join(os.environ["SCENES"], "fascia.json")) as session:
                while not over.is_set():
                    session.step()
        quiet = play(task, 1)
        threads = [threading.Thread(target=load) for _ in range(os.cpu_count())]
        for thread in threads:
            thread.start()
        try:
            loaded = [play(task, 1) for _ in SEEDS]
        finally:
            over.set()
            for thread in threads:
                thread.join()
        self.assertTrue(all(np.array_equal(quiet, one) for one in loaded))

    def test_resets_do_not_grow(self):
        task = self.task(tissue_count=1)

        def reset(times):
            for i in range(times):
                task.reset(seed=i)
        reset(RESETS // 4)
        before = resident_bytes()
        reset(RESETS)
        self.assertLess(resident_bytes() - before, GROWTH_BYTES)

    def test_what_a_closed_task_is_asked_for_is_refused(self):
        tissue = CoreTissue()
        tissue.begin(cautery.environments.part_band.scene(1), ("exposure",))
        tissue.close()
        tissue.close()
        with self.assertRaises(ValueError):
            tissue.step([], 1)
        for how in ({"tissue_count": 0}, {"kept": 0}, {"render_mode": "human"}):
            with self.assertRaises(ValueError):
                PartBand(**how)

    def test_the_blocks_of_the_readme_run(self):
        with open(os.path.join(PACKAGE, "README.md"), encoding="utf-8") as file:
            [block] = [one for one in re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL) if "PartBand" in one]
        known = {}
        exec(block, known)  # pylint: disable=exec-used
        self.assertTrue(known["tasks"].closed)
        self.assertEqual(known["rewards"].shape, (4,))


class Vector(unittest.TestCase):
    def vector(self, threads):
        made = VectorEnvironment([lambda: PartBand(tissue_count=2, steps_most=6)] * COUNT, threads)
        self.addCleanup(made.close)
        return made

    def test_it_keeps_the_rules_of_the_interface(self):
        self.assertEqual(check_vector_environment(self.vector(2), 10), [])

    def test_the_number_of_threads_changes_nothing(self):
        seen = []
        for threads in (1, COUNT):
            vector = self.vector(threads)
            observations, _ = vector.reset(seed=3)
            random, steps = np.random.default_rng(1), [observations]
            for _ in range(10):
                observations, rewards, *_ = vector.step(random.uniform(-1, 1, (COUNT, 4)))
                steps.append(np.c_[observations, rewards])
            seen.append(steps)
        for other in seen[1:]:
            self.assertTrue(all(np.array_equal(a, b) for a, b in zip(seen[0], other, strict=True)))


if __name__ == "__main__":
    unittest.main()
