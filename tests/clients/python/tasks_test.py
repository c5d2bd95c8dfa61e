# SPDX-License-Identifier: GPL-3.0-or-later
"""The tasks with several tools, with a daemon. PYTHONPATH has the package, its examples and tests/clients/e2e; PROGRAMS and
SCENES are as in programs.py."""

import os
import re
import unittest

import numpy as np

import cautery
from cautery.environments import ClearPlane, SealAndDivide, check_environment

import programs
import scripted_policies

DAEMON = os.path.join(programs.PROGRAMS, "cauteryd")


class Tasks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for kind in (ClearPlane, SealAndDivide):
            task = kind(daemon=DAEMON, scenes=os.environ["SCENES"], render_mode="rgb_array")
            cls.addClassCleanup(task.close)
            setattr(cls, kind.__name__, task)

    def test_they_keep_the_rules_of_the_interface(self):
        for task in (self.ClearPlane, self.SealAndDivide):
            with self.subTest(type(task).__name__):
                self.assertEqual(check_environment(task), [])
                self.assertIs(task.unwrapped, task)

    def test_a_scripted_policy_clears_the_plane(self):
        total, info, steps = scripted_policies.play(self.ClearPlane, 1, scripted_policies.clear)
        self.assertTrue(info["cleared"])
        self.assertEqual(info["faces_burnt_above"] + info["faces_burnt_below"], 0)
        self.assertGreater(total, 17)
        self.assertTrue((steps[1:, 6] == 1).all())  # the grasper holds all the time

    def test_an_artery_that_is_divided_without_a_seal_bleeds_and_equal_seeds_bleed_alike(self):
        one, other = (scripted_policies.play(self.SealAndDivide, 2, scripted_policies.divide) for _ in range(2))
        self.assertGreater(one[1]["shed_m3"], 1e-6)
        self.assertLess(one[0], -2)
        self.assertTrue(np.array_equal(one[2], other[2]))
        with self.assertRaises(cautery.Error):
            self.SealAndDivide.step(np.zeros(7))

    def test_a_needle_that_all_but_lost_its_tissue_has_no_load(self):
        """In this episode it is joined to it by 1e-34 S for a step, which is no number for the wire."""
        _, info, steps = scripted_policies.play(self.SealAndDivide, 7, scripted_policies.divide)
        self.assertGreater(info["shed_m3"], 1e-6)
        self.assertTrue((steps[:, 12] <= 1).all())

    def test_actions_that_are_none_are_refused(self):
        for task, count in ((self.ClearPlane, 5), (self.SealAndDivide, 7)):
            task.reset(seed=4)
            for action in (np.zeros(count - 1), np.full(count, np.nan)):
                with self.assertRaises(ValueError):
                    task.step(action)

    def test_an_episode_begins_where_options_say(self):
        _, info = self.ClearPlane.reset(seed=1, options={"tip_m": [0.001, -0.007, -0.001]})
        self.assertEqual(info["tip_m"].tolist(), [0.001, -0.007, -0.001])
        _, info = self.SealAndDivide.reset(seed=1, options={"forceps_x_m": 0.002})
        self.assertEqual(info["forceps_m"][0], 0.002)

    def test_the_block_of_the_readme_runs(self):
        with open(os.path.join(os.path.dirname(os.path.dirname(cautery.__file__)), "README.md"), encoding="utf-8") as file:
            (block,) = [one for one in re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL) if "SealAndDivide" in one]
        block = block.replace("build/bin/cauteryd", DAEMON).replace("deploy/scenes", os.environ["SCENES"])
        known = {}
        exec(block, known)  # pylint: disable=exec-used
        self.assertEqual(known["observation"].shape, (21,))


if __name__ == "__main__":
    unittest.main()
