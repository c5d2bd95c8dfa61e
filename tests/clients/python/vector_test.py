# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors of environments, and the checker of their interface, on environments without a simulation."""

import threading
import unittest

import numpy as np

import cautery
from cautery.environments import AutoresetMode, Box, VectorEnvironment, check_vector_environment

from plain_environment import Plain

COUNT = 3
STEPS = 60


class Ending(Plain):
    """Ends soon, and counts in its infos."""

    farthest = 1.5

    def __init__(self):
        super().__init__()
        self.steps = 0
        self.closed = False

    def reset(self, *, seed=None, options=None):
        self.steps = 0
        observation, _ = super().reset(seed=seed, options=options)
        return observation, {"steps": 0, "place_m": self.place.copy(), "name": "plain"}

    def step(self, action):
        self.steps += 1
        return (*super().step(action)[:4], {"steps": self.steps, **({"even": True} if self.steps % 2 == 0 else {})})

    def close(self):
        self.closed = True


class Failing(Ending):
    def step(self, action):
        if self.steps == 1:
            raise RuntimeError("as asked")
        return super().step(action)


def vector(kind=Ending, threads=1):
    return VectorEnvironment([kind] * COUNT, threads)


class Vector(unittest.TestCase):
    def test_it_keeps_the_rules_of_the_interface(self):
        for threads in (1, 4):
            with self.subTest(threads), vector(threads=threads) as one:
                self.assertEqual(check_vector_environment(one, STEPS), [])

    def play(self, threads):
        with vector(threads=threads) as one:
            seen = [one.reset(seed=[5, 6, 7])[0]]
            random = np.random.default_rng(1)
            for _ in range(STEPS):
                observations, rewards, ended, _, _ = one.step(random.uniform(-1, 1, (COUNT, 1)))
                seen.append(np.c_[observations, rewards, ended])
        return seen

    def test_the_number_of_threads_changes_nothing(self):
        one, four = self.play(1), self.play(4)
        self.assertTrue(all(np.array_equal(a, b) for a, b in zip(one, four, strict=True)))
        self.assertGreater(sum(step[:, 3].sum() for step in one[1:]), 5)

    def test_each_environment_does_what_it_does_alone(self):
        """Its rewards are those of the environment by itself, with a reset in the step after an end."""
        with vector() as one:
            first, _ = one.reset(seed=11)
            alone = [Ending() for _ in range(COUNT)]
            for i, environment in enumerate(alone):
                self.assertTrue(np.array_equal(environment.reset(seed=11 + i)[0], first[i]))
            ended, random, ends = [False] * COUNT, np.random.default_rng(2), 0
            for _ in range(STEPS):
                actions = random.uniform(-1, 1, (COUNT, 1))
                observations, rewards, terminations, truncations, _ = one.step(actions)
                for i, environment in enumerate(alone):
                    if ended[i]:
                        expected = (environment.reset()[0], 0.0, False)
                    else:
                        expected = environment.step(actions[i])[:3]
                    ends += expected[2]
                    self.assertTrue(np.array_equal(observations[i], expected[0]))
                    self.assertEqual((rewards[i], terminations[i], truncations[i]), (*expected[1:], False))
                    ended[i] = expected[2]
            self.assertGreater(ends, 5)

    def test_infos_are_arrays_with_masks(self):
        with vector() as one:
            _, infos = one.reset(seed=1)
            self.assertEqual(infos["place_m"].shape, (COUNT, 2))
            self.assertEqual(infos["name"].tolist(), ["plain"] * COUNT)
            self.assertTrue(infos["_steps"].all())
            *_, infos = one.step(np.zeros((COUNT, 1)))
            self.assertNotIn("even", infos)
            self.assertEqual(infos["steps"].tolist(), [1] * COUNT)
        self.assertTrue(all(environment.closed for environment in one.environments))

    def test_the_mode_is_stated(self):
        with vector() as one:
            self.assertIs(one.metadata["autoreset_mode"], AutoresetMode.NEXT_STEP)
            self.assertEqual(one.metadata["autoreset_mode"].value, "NextStep")

    def test_mistakes_are_refused(self):
        with vector() as one:
            with self.assertRaises(cautery.Error):
                one.step(np.zeros((COUNT, 1)))
            one.reset()
            for actions in (np.zeros(COUNT), np.zeros((COUNT + 1, 1)), np.zeros((1, 1))):
                with self.assertRaises(ValueError):
                    one.step(actions)
            with self.assertRaises(ValueError):
                one.reset(seed=[1, 2])
        with self.assertRaises(cautery.Error):
            one.reset()
        one.close()
        with self.assertRaises(ValueError):
            VectorEnvironment([])

    def test_environments_of_different_spaces_are_none(self):
        made = []

        def other():
            made.append(Ending())
            made[-1].action_space = Box([-2.0], [2.0])
            return made[-1]
        with self.assertRaises(ValueError):
            VectorEnvironment([Ending, other])
        self.assertTrue(made[0].closed)

    def test_an_error_comes_out_once_all_are_done(self):
        for threads in (1, 4):
            with self.subTest(threads), VectorEnvironment([Ending, Failing, Ending], threads) as one:
                one.reset(seed=1)
                one.step(np.zeros((COUNT, 1)))
                with self.assertRaisesRegex(RuntimeError, "as asked"):
                    one.step(np.zeros((COUNT, 1)))
                with self.assertRaises(cautery.Error):
                    one.step(np.zeros((COUNT, 1)))
                one.reset(seed=1)

    def test_environments_step_at_the_same_time(self):
        """Each waits until the others are in their step too."""
        together = threading.Barrier(COUNT, timeout=60)

        class Meeting(Ending):
            def step(self, action):
                together.wait()
                return super().step(action)
        with vector(Meeting, threads=COUNT) as one:
            one.reset()
            one.step(np.zeros((COUNT, 1)))


def broken(**members):
    return type("Broken", (VectorEnvironment,), members)([Ending] * COUNT)


def of_step(change):
    return broken(step=lambda self, actions: change(*VectorEnvironment.step(self, actions)))


def of_reset(change):
    return broken(reset=lambda self, *, seed=None, options=None: change(
        *VectorEnvironment.reset(self, seed=seed, options=options)))


def same_seed(self, *, seed=None, options=None):
    return VectorEnvironment.reset(self, seed=[seed] * COUNT if isinstance(seed, int) else seed, options=options)


def by_place(self, *, seed=None, options=None):
    seeds = [one + i for i, one in enumerate(seed)] if isinstance(seed, list) else seed
    return VectorEnvironment.reset(self, seed=seeds, options=options)


def by_sum(self, *, seed=None, options=None):
    seeds = [seed + i for i in range(COUNT)] if isinstance(seed, int) else seed
    return VectorEnvironment.reset(self, seed=[sum(seeds)] * COUNT, options=options)


def no_reset(self, number, action, ended):
    del ended
    return self.environments[number].step(action)


def rewarded_reset(self, number, action, ended):
    observation, reward, *rest = VectorEnvironment._step_one(self, number, action, ended)
    return (observation, 1.0 if ended else reward, *rest)


def chance(self, number, action, ended):
    observation, _, *rest = VectorEnvironment._step_one(self, number, action, ended)
    return (observation, 0.0 if ended else float(np.random.default_rng().uniform()), *rest)


def changes_actions(self, actions):
    result = VectorEnvironment.step(self, actions)
    actions[0] = 5
    return result


def shares_memory(self, actions):
    observations, *rest = VectorEnvironment.step(self, actions)
    if not hasattr(self, "shared"):
        self.shared = np.zeros_like(observations)
    self.shared[:] = observations
    return (self.shared, *rest)


class Checker(unittest.TestCase):
    def test_each_broken_rule_is_found_and_named(self):
        cases = {
            "reset": (of_reset(lambda observations, infos: observations), "pair"),
            "first observations": (of_reset(lambda o, i: (o + 20, i)), "reset returns observations outside"),
            "infos of reset": (of_reset(lambda o, i: (o, None)), "infos that are no dictionary"),
            "no mask": (of_reset(lambda o, i: (o, {"steps": i["steps"]})), "no mask"),
            "infos too short": (of_reset(lambda o, i: (o, {**i, "steps": 3})), "no value"),
            "four values": (of_step(lambda o, r, t, u, i: (o, r, t, i)), "does not return (observations"),
            "one observation": (of_step(lambda o, r, t, u, i: (o[0], r, t, u, i)), "step returns observations outside"),
            "one reward": (of_step(lambda o, r, t, u, i: (o, 1.0, t, u, i)), "rewards"),
            "reward not finite": (of_step(lambda o, r, t, u, i: (o, r * np.nan, t, u, i)), "finite"),
            "a list of ends": (of_step(lambda o, r, t, u, i: (o, r, t.tolist(), u, i)), "terminations"),
            "ends as numbers": (of_step(lambda o, r, t, u, i: (o, r, t, u.astype(int), i)), "truncations"),
            "infos of step": (of_step(lambda o, r, t, u, i: (o, r, t, u, [])), "infos that are no dictionary"),
            "one seed for all": (broken(reset=same_seed), "s + i"),
            "not by the seed alone": (broken(reset=by_place), "different environments"),
            "seeds of others": (broken(reset=by_sum), "seeds of the others"),
            "no reset after an end": (broken(_step_one=no_reset), "ends again"),
            "a reward for a reset": (broken(_step_one=rewarded_reset), "gives a reward"),
            "chance": (broken(_step_one=chance), "unequal episodes"),
            "actions changed": (broken(step=changes_actions), "changes the actions"),
            "memory shared": (broken(step=shares_memory), "change after they were returned"),
            "keywords": (broken(reset=lambda self: VectorEnvironment.reset(self)), "TypeError"),
        }
        for what, (one, words) in cases.items():
            with self.subTest(what), one:
                found = check_vector_environment(one, STEPS)
                self.assertTrue(any(words in rule for rule in found), found)

    def test_each_broken_member_is_found_and_named(self):
        cases = {"num_envs": ("num_envs", 0, "num_envs"), "no count": ("num_envs", None, "num_envs"),
                 "mode": ("metadata", {}, "autoreset_mode"), "space": ("action_space", None, "is no space"),
                 "of one": ("observation_space", Box([-10.0, 0.0], [10.0, 1.0]), "not num_envs times")}
        for what, (name, value, words) in cases.items():
            with self.subTest(what), vector() as one:
                setattr(one, name, value)
                found = check_vector_environment(one)
                self.assertTrue(any(words in rule for rule in found), found)


if __name__ == "__main__":
    unittest.main()
