# SPDX-License-Identifier: GPL-3.0-or-later
"""The tasks with several tools, in this process. PYTHONPATH has both packages, the examples and tests/clients/e2e;
PROGRAMS and SCENES are as in programs.py."""

import os
import re
import unittest

import numpy as np

import cautery.environments
import cautery_core
from cautery.environments import check_environment
from cautery.environments.clear_plane import FORCE_MOST_N
from cautery_core.environments import ClearPlane, CoreTissue, SealAndDivide

import programs
import scripted_policies

PACKAGE = os.path.dirname(os.path.dirname(cautery_core.__file__))
CLEARED_SEEDS, SEALED_SEEDS = (0, 3, 5, 8), (1, 4)
BESIDE_M = 0.006  # from the middle of the jaws, which are 6 mm wide
LOOSE_M = 0.0005  # height of a grasper that gives no traction
WIRES_M = (0.0005, 0.0006, 0.0007, 0.0008)  # heights of the wire over the lower sheet
SEAL = 15  # steps of an episode that is compared: the forceps have closed and heat
PLANE = 30  # the first strands have parted


def steps_of(task, seed, policy):
    return scripted_policies.play(task, seed, policy)[2]


class Tasks(unittest.TestCase):
    def made(self, kind, **how):
        made = kind(**how)
        self.addCleanup(made.close)
        return made

    def test_they_keep_the_rules_of_the_interface(self):
        for kind in (ClearPlane, SealAndDivide):
            with self.subTest(kind.__name__):
                self.assertEqual(check_environment(self.made(kind, render_mode="rgb_array")), [])

    def test_episodes_are_those_of_a_daemon_to_the_bit(self):
        for kind, steps, policy in ((ClearPlane, PLANE, scripted_policies.clear), (SealAndDivide, 12 + SEAL, self.heat)):
            with self.subTest(kind.__name__):
                daemon = self.made(getattr(cautery.environments, kind.__name__), steps_most=steps,
                                   daemon=os.path.join(programs.PROGRAMS, "cauteryd"), scenes=os.environ["SCENES"])
                one, other = (steps_of(task, 2, policy) for task in (daemon, self.made(kind, steps_most=steps)))
                self.assertEqual(len(one), steps + 1)
                self.assertTrue(np.array_equal(one, other))
                self.assertGreater(np.abs(one[-1] - one[0]).max(), 0.1)

    @staticmethod
    def heat(info):
        return scripted_policies.seal(info, SEAL)

    def test_a_reset_restores_to_the_bit(self):
        for kind, policy in ((ClearPlane, scripted_policies.clear), (SealAndDivide, scripted_policies.divide)):
            with self.subTest(kind.__name__):
                task = self.made(kind, tissue_count=1, steps_most=PLANE)
                first, again = steps_of(task, 4, policy), steps_of(task, 4, policy)
                self.assertTrue(np.array_equal(first, again))
                self.assertGreater(len(first), 10)

    def test_pictures_show_what_is_there(self):
        for kind, shape, colour in ((ClearPlane, (110, 150, 3), (255, 245, 235)),
                                    (SealAndDivide, (60, 200, 3), (230, 150, 130))):
            with self.subTest(kind.__name__):
                task = self.made(kind, render_mode="rgb_array")
                task.reset(seed=1)
                picture = task.render()
                self.assertEqual((picture.shape, picture.dtype), (shape, np.uint8))
                self.assertGreater((picture == colour).all(axis=2).mean(), 0.2)
                self.assertIsNone(self.made(kind).render())

    def test_the_block_of_the_readme_runs(self):
        with open(os.path.join(PACKAGE, "README.md"), encoding="utf-8") as file:
            [block] = [one for one in re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL) if "ClearPlane" in one]
        known = {}
        exec(block, known)  # pylint: disable=exec-used
        self.assertIn("strands_parted", known["info"])


class Clearing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.task = ClearPlane()
        cls.addClassCleanup(cls.task.close)

    def test_a_scripted_policy_clears_the_plane_and_burns_nothing(self):
        for seed in CLEARED_SEEDS:
            with self.subTest(seed=seed):
                total, info, _ = scripted_policies.play(self.task, seed, scripted_policies.clear)
                self.assertTrue(info["cleared"])
                self.assertEqual(info["faces_burnt_above"] + info["faces_burnt_below"], 0)
                self.assertGreater(total, 17)

    def test_without_traction_the_same_policy_burns_the_upper_sheet(self):
        for seed in CLEARED_SEEDS[:2]:
            total, info, _ = scripted_policies.play(self.task, seed, lambda info: scripted_policies.clear(info, LOOSE_M))
            self.assertFalse(info["cleared"])
            self.assertGreater(info["faces_burnt_above"], 0)
            self.assertLess(total, 10)

    def test_without_traction_a_wire_of_any_height_burns_a_sheet(self):
        for wire_m in WIRES_M:
            with self.subTest(wire_m=wire_m):
                _, info, _ = scripted_policies.play(self.task, CLEARED_SEEDS[0],
                                                    lambda info, at_m=wire_m: scripted_policies.clear(info, LOOSE_M, at_m))
                self.assertFalse(info["cleared"])
                self.assertGreater(info["faces_burnt_above"] + info["faces_burnt_below"], 0)

    def test_more_traction_than_that_costs(self):
        self.task.reset(seed=1)
        lifted = np.array([0, 0, 0, 1, -1])
        for _ in range(20):
            _, reward, *_, info = self.task.step(lifted)
        self.assertGreater(info["force_n"], FORCE_MOST_N)
        self.assertLess(reward, -0.01)
        self.assertEqual(info["strands_parted"], 0)

    def test_each_strand_that_the_core_has_parted_is_counted(self):
        """The core counts all elements that it has removed; those that are no faces are strands."""
        tissue = CoreTissue()
        task = cautery.environments.ClearPlane(tissue=tissue, steps_most=80)
        self.addCleanup(task.close)
        _, info = task.reset(seed=1)
        session = tissue.session
        for action in scripted_policies.clear(info):
            _, _, terminated, truncated, info = task.step(action)
            gone = session.statistics["elements_removed"] - int(session.removed.sum())
            self.assertEqual(info["strands_parted"], gone)
            if terminated or truncated:
                break
        self.assertEqual(info["strands"], len(session.links))
        self.assertGreater(info["strands_parted"], 40)


class Sealing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.task = SealAndDivide()
        cls.addClassCleanup(cls.task.close)

    def test_a_scripted_policy_seals_and_divides_without_blood(self):
        for seed in SEALED_SEEDS:
            with self.subTest(seed=seed):
                total, info, _ = scripted_policies.play(self.task, seed, scripted_policies.seal)
                self.assertTrue(info["divided"] and info["sealed"])
                self.assertGreaterEqual(info["burst_pa"], info["pressure_pa"])
                self.assertEqual(info["shed_m3"], 0)
                self.assertGreater(total, 14)

    def test_an_artery_that_is_divided_without_a_seal_bleeds(self):
        for seed in SEALED_SEEDS:
            total, info, steps = scripted_policies.play(self.task, seed, scripted_policies.divide)
            self.assertTrue(info["parted"])
            self.assertFalse(info["sealed"])
            self.assertGreater(info["shed_m3"], 1e-6)
            self.assertLess(total, -2)
            self.assertTrue((steps[:, 14] == 0).all())  # no burst pressure at any time

    def test_an_artery_that_is_divided_beside_its_seal_bleeds(self):
        def beside(info):
            return scripted_policies.seal(info, beside_m=-np.sign(info["forceps_m"][0]) * BESIDE_M)
        total, info, steps = scripted_policies.play(self.task, SEALED_SEEDS[1], beside)
        self.assertEqual(steps[:, 16].max(), 1)  # it was sealed
        self.assertTrue(info["parted"])
        self.assertGreater(info["shed_m3"], 1e-6)
        self.assertLess(total, 5)

    def test_heat_between_open_jaws_seals_nothing(self):
        _, info = self.task.reset(seed=SEALED_SEEDS[0])
        for action in scripted_policies.seal(info, SEAL):
            action[2] = -1
            *_, info = self.task.step(action)
            if info["tick"] > 5 * 30:
                break
        self.assertEqual(info["burst_pa"], 0)


if __name__ == "__main__":
    unittest.main()
