# SPDX-License-Identifier: GPL-3.0-or-later
"""What run.py makes of figures, and the geometry that they rest on."""

import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import geometry  # noqa: E402
import patterns  # noqa: E402
import run  # noqa: E402

TRIANGLE = ((0, 0, 0), (2, 0, 0), (0, 1, 0))


class Figures(unittest.TestCase):
    def test_what_is_as_expected_is_not_complained_of(self):
        self.assertEqual(run.compare({"a": 1.05, "b": 2}, {"a": [1, 0.1], "b": [2, 0]}), [])

    def test_what_is_off_missing_unknown_or_none_is(self):
        self.assertEqual(run.compare({"a": 1.2}, {"a": [1, 0.1]}), ["a = 1.2, expected 1 within 0.1"])
        self.assertEqual(run.compare({}, {"a": [1, 0.1]}), ["a: not measured"])
        self.assertEqual(run.compare({"a": 1}, {}), ["a = 1, which expected.json does not have"])
        self.assertEqual(len(run.compare({"a": math.nan}, {"a": [1, 0.1]})), 1)


class Geometry(unittest.TestCase):
    def test_strain_is_by_axis(self):
        now = [(1.1 * x, 3 * y, 5) for x, y, _ in TRIANGLE]
        self.assertAlmostEqual(geometry.strain(TRIANGLE, now, (1, 0)), 0.1)
        self.assertAlmostEqual(geometry.strain(TRIANGLE, now, (0, 1)), 2)
        self.assertAlmostEqual(geometry.strain(TRIANGLE, now, (0.6, 0.8)), math.hypot(0.66, 2.4) - 1)

    def test_turning_is_no_strain(self):
        now = [(-y, 0, x) for x, y, _ in TRIANGLE]
        self.assertAlmostEqual(geometry.strain(TRIANGLE, now, (0.6, 0.8)), 0)

    def test_distance_of_a_triangle_and_a_stroke(self):
        flat = [corner[:2] for corner in TRIANGLE]
        self.assertEqual(geometry.triangle_distance(flat, (0.2, 0.2), (5, 5)), 0)  # begins inside
        self.assertEqual(geometry.triangle_distance(flat, (-1, 0.3), (4, 0.3)), 0)  # passes through
        self.assertAlmostEqual(geometry.triangle_distance(flat, (-1, -2), (4, -2)), 2)
        self.assertAlmostEqual(geometry.triangle_distance(flat, (3, 0), (3, 0)), 1)  # a point


class Strokes(unittest.TestCase):
    def test_the_same_seed_gives_the_same_strokes_within_the_fan(self):
        first, second = (patterns.random.Random(1) for _ in range(2))
        for _ in range(20):
            stroke = patterns.random_stroke(first)
            self.assertEqual(stroke, patterns.random_stroke(second))
            self.assertLessEqual(max(math.hypot(*stroke[0]), math.hypot(*stroke[1])), patterns.RADIUS_M)
            self.assertGreaterEqual(stroke[2], 0.2)


if __name__ == "__main__":
    unittest.main()
