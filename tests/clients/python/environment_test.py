# SPDX-License-Identifier: GPL-3.0-or-later
"""The tasks for learners, and the checker of their interface. PYTHONPATH has the package, its examples and
tests/clients/e2e; PROGRAMS and SCENES are as in programs.py."""

import os
import re
import unittest

import numpy as np

import cautery
from cautery.environments import Box, PartBand, check_environment
from cautery.environments.part_band import STEPS_MOST

import learn_part_band
import programs
from plain_environment import Plain

DAEMON = os.path.join(programs.PROGRAMS, "cauteryd")
# Numbers of a policy that parts the band: the tip in it, slowly, whatever the sheet below has taken up.
KNOWN = np.array([0.2, 0.6, 0.5, 1.0])
SEEDS = 5


def task(**how):
    return PartBand(daemon=DAEMON, scenes=os.environ["SCENES"], **how)


class Task(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.task = task(render_mode="rgb_array")
        cls.addClassCleanup(cls.task.close)

    def test_it_keeps_the_rules_of_the_interface(self):
        self.assertEqual(check_environment(self.task), [])

    def test_a_known_policy_parts_the_band_and_burns_nothing_below(self):
        ends = [learn_part_band.play(self.task, KNOWN, 1000 + seed) for seed in range(SEEDS)]
        self.assertTrue(all(done for _, done in ends), ends)
        self.assertTrue(all(total > 15 for total, _ in ends), ends)

    def test_energy_far_below_burns_what_is_there(self):
        _, info = self.task.reset(seed=1, options={"tip_m": [0, 0, -0.004]})
        terminated = False
        for _ in range(STEPS_MOST):
            _, reward, terminated, truncated, info = self.task.step([0, 0, 0, 1])
            if terminated or truncated:
                break
        self.assertTrue(terminated)
        self.assertGreater(info["faces_burnt_below"], 0)
        self.assertLess(reward, 0)
        with self.assertRaises(cautery.Error):
            self.task.step([0, 0, 0, 0])

    def test_an_episode_ends_by_itself(self):
        self.task.reset(seed=2)
        ends = [self.task.step([0, 0, 1, -1])[2:4] for _ in range(STEPS_MOST)]
        self.assertEqual(ends[-1], (False, True))
        self.assertEqual(set(ends[:-1]), {(False, False)})

    def test_episodes_are_equal_to_the_bit(self):
        episodes = []
        for _ in range(2):
            observation, info = self.task.reset(seed=3)
            policy, seen, over = learn_part_band.Policy(KNOWN, info["tip_m"][0]), [observation], False
            while not over:
                observation, _, terminated, truncated, _ = self.task.step(policy.act(seen[-1]))
                seen.append(observation)
                over = terminated or truncated
            episodes.append(np.array(seen))
        self.assertGreater(len(episodes[0]), 20)
        self.assertTrue(np.array_equal(*episodes))

    def test_the_block_of_the_readme_runs(self):
        with open(os.path.join(os.path.dirname(os.path.dirname(cautery.__file__)), "README.md"), encoding="utf-8") as file:
            (block,) = [one for one in re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL) if "PartBand" in one]
        block = block.replace("build/bin/cauteryd", DAEMON).replace("deploy/scenes", os.environ["SCENES"])
        known = {}
        exec(block, known)  # pylint: disable=exec-used
        self.assertTrue(self.task.observation_space.contains(known["observation"]))

    def test_actions_that_are_none_are_refused(self):
        self.task.reset(seed=4)
        for action in ([0, 0, 0], [np.nan, 0, 0, 0], [[0, 0, 0, 0]]):
            with self.assertRaises(ValueError):
                self.task.step(action)

    def test_a_picture_shows_the_band(self):
        self.task.reset(seed=5)
        picture = self.task.render()
        self.assertEqual((picture.shape, picture.dtype), ((60, 150, 3), np.uint8))
        self.assertGreater((picture == (220, 150, 130)).all(axis=2).mean(), 0.5)


def broken(name, **members):
    return type(name, (Plain,), members)()


def of_step(change):
    """An environment whose step returns something else."""
    return broken("Step", step=lambda self, action: change(*Plain.step(self, action)))


def of_reset(change):
    return broken("Reset", reset=lambda self, *, seed=None, options=None: change(self, *Plain.reset(self, seed=seed, options=options)))


def forgets_seed(self, *, seed=None, options=None):
    del seed
    return Plain.reset(self, options=options)


def repeats_seed(self, *, seed=None, options=None):
    self.last = seed if seed is not None else self.last
    return Plain.reset(self, seed=self.last, options=options)


def changes_action(self, action):
    result = Plain.step(self, action)
    action[0] = 5
    return result


def shares_memory(self, action):
    _, *rest = Plain.step(self, action)
    return (self.place, *rest)


def draws_by_itself(self, action):
    observation, _, *rest = Plain.step(self, action)
    return (observation, float(np.random.default_rng().uniform()), *rest)


class Checker(unittest.TestCase):
    def test_an_environment_that_keeps_all_rules_passes(self):
        self.assertEqual(check_environment(Plain()), [])

    def test_each_broken_rule_is_found_and_named(self):
        cases = {
            "of the old interface": (of_reset(lambda self, observation, info: observation), "pair"),
            "info of reset": (of_reset(lambda self, observation, info: (observation, None)), "info that is no dictionary"),
            "first observation": (of_reset(lambda self, observation, info: (observation + 20, info)), "outside observation_space"),
            "four values": (of_step(lambda o, r, t, u, i: (o, r, t, i)), "does not return (observation"),
            "type of observation": (of_step(lambda o, r, t, u, i: (o.astype(float), r, t, u, i)), "outside observation_space"),
            "reward not finite": (of_step(lambda o, r, t, u, i: (o, float("nan"), t, u, i)), "finite"),
            "terminated": (of_step(lambda o, r, t, u, i: (o, r, int(t), u, i)), "terminated"),
            "truncated": (of_step(lambda o, r, t, u, i: (o, r, t, None, i)), "truncated"),
            "info of step": (of_step(lambda o, r, t, u, i: (o, r, t, u, [])), "info that is no dictionary"),
            "seed": (broken("Seed", reset=forgets_seed), "equal seeds begin unequal"),
            "no drawing on": (broken("Repeats", reset=repeats_seed, last=None), "go on drawing"),
            "action changed": (broken("Action", step=changes_action), "changes the action"),
            "memory shared": (broken("Shares", step=shares_memory), "changes after it was returned"),
            "not by the seed": (broken("Draws", step=draws_by_itself), "equal seeds and actions"),
            "no spaces": (broken("Space", __init__=lambda self: None), "is no space"),
            "modes": (broken("Modes", metadata={}), "render_modes"),
            "mode": (broken("Mode", render_mode="human"), "render_mode"),
            "keywords": (broken("Words", reset=lambda self: Plain.reset(self)), "TypeError"),
        }
        for what, (environment, words) in cases.items():
            with self.subTest(what):
                found = check_environment(environment)
                self.assertTrue(any(words in one for one in found), found)


class Spaces(unittest.TestCase):
    def test_a_box_contains_what_it_samples_and_nothing_else(self):
        box = Box([-1, 0], [1, 2])
        box.seed(1)
        first = [box.sample() for _ in range(5)]
        box.seed(1)
        self.assertTrue(np.array_equal(first, [box.sample() for _ in range(5)]))
        self.assertTrue(all(box.contains(one) for one in first))
        for other in (np.zeros(2), np.array([2, 0], np.float32), np.zeros(3, np.float32), [0, 0]):
            self.assertNotIn(other, box)
        with self.assertRaises(ValueError):
            Box([1], [0])


if __name__ == "__main__":
    unittest.main()
