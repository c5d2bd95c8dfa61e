# SPDX-License-Identifier: GPL-3.0-or-later
"""What run.py makes of figures, and the geometry that they rest on."""

import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import dissection  # noqa: E402
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


class Cuts(unittest.TestCase):
    # Three rows of squares, each of two triangles, of 1 by 1, six long, about the x axis.
    REST = [(x - 3, y - 1.5, 0) for y in range(4) for x in range(7)]

    def cells(self, without=()):
        corners = [(7 * y + x, 7 * y + x + 1, 7 * y + x + 8, 7 * y + x + 7)
                   for y in range(3) for x in range(6) if (x, y) not in without]
        return [t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))]

    def flat(self, cells):
        return [[self.REST[v][:2] for v in cell] for cell in cells]

    def test_a_gap_is_what_nothing_covers_between_tissue(self):
        self.assertEqual(dissection.gaps(self.flat(self.cells()), 0.5, 5), [])
        cut = self.flat(self.cells(without=[(3, 1)]))
        self.assertEqual(dissection.gaps(cut, 0.5, 5), [(-0.5, 0.5)])
        self.assertEqual(dissection.gaps(cut, 1.5, 5), [])

    def test_strands_join_both_sides(self):
        self.assertEqual(dissection.strands(self.REST, self.cells(), 2.5, 1.5)[0], 1)  # whole
        middle = [(x, 1) for x in range(6)]
        self.assertEqual(dissection.strands(self.REST, self.cells(without=middle), 2.5, 1.5)[0], 0)
        left = [square for square in middle if square[0] not in (1, 4)]
        all_but_two = left + [(x, y) for x in range(6) if x not in (1, 4) for y in (0, 2)]
        self.assertEqual(dissection.strands(self.REST, self.cells(without=all_but_two), 3, 1.5)[0], 2)

    def test_a_straight_lip_is_not_rough_and_a_toothed_one_is(self):
        stations = [0.001 * k for k in range(40)]
        self.assertEqual(dissection.roughness(stations, [0.5] * 40), 0)
        toothed = [0.001 * (-1) ** k for k in range(40)]
        self.assertAlmostEqual(dissection.roughness(stations, toothed), 0.001, delta=2e-4)

    def test_a_hole_is_one_walk(self):
        whole, left = self.cells(), self.cells(without=[(3, 1)])
        edges = dissection.edges_of(left) - dissection.edges_of(whole)
        self.assertEqual(len(edges), 4)
        walks = dissection.loops(edges)
        self.assertEqual([len(walk) for walk in walks], [5])
        self.assertEqual(walks[0][0], walks[0][-1])


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
