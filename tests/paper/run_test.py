# SPDX-License-Identifier: GPL-3.0-or-later
"""What run.py makes of figures, and the geometry that they rest on."""

import math
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import contact  # noqa: E402
import cuts  # noqa: E402
import dissection  # noqa: E402
import elements  # noqa: E402
import geometry  # noqa: E402
import heat  # noqa: E402
import held  # noqa: E402
import measured  # noqa: E402
import patterns  # noqa: E402
import plots  # noqa: E402
import run  # noqa: E402
import sim  # noqa: E402
import viewer  # noqa: E402

TRIANGLE = ((0, 0, 0), (2, 0, 0), (0, 1, 0))


class Figures(unittest.TestCase):
    def test_what_is_as_expected_is_not_complained_of(self):
        self.assertEqual(run.compare({"a": 1.05, "b": 2}, {"a": [1, 0.1], "b": [2, 0]}), [])

    def test_what_is_off_missing_unknown_or_none_is(self):
        self.assertEqual(run.compare({"a": 1.2}, {"a": [1, 0.1]}), ["a = 1.2, expected 1 within 0.1"])
        self.assertEqual(run.compare({}, {"a": [1, 0.1]}), ["a: not measured"])
        self.assertEqual(run.compare({"a": 1}, {}), ["a = 1, which expected.json does not have"])
        self.assertEqual(len(run.compare({"a": math.nan}, {"a": [1, 0.1]})), 1)


class Parts(unittest.TestCase):
    def test_a_part_that_cannot_be_made_says_so_and_the_others_are_made(self):
        class Broken:
            @staticmethod
            def run(_sim, _folder, _quick):
                raise OSError("no such program")

        class Whole:
            @staticmethod
            def run(_sim, _folder, _quick):
                return {"whole": 1}, "details"

            @staticmethod
            def page(details):
                return f"of {details}"
        kept, run.PARTS = run.PARTS, {"broken": Broken, "whole": Whole}
        try:
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "kept.json")
                figures, sections, failed, _ = run.run_parts(None, ["broken", "whole"], False, path)
                again = run.run_parts(None, ["whole"], False, path)
        finally:
            run.PARTS = kept
        self.assertEqual(again[:2], ({}, {"whole": "of details"}))  # it was not made again
        self.assertEqual((figures, list(failed), sections["whole"]), ({"whole": 1}, ["broken"], "of details"))
        self.assertIn("Could not be made this time: OSError: no such program", sections["broken"])
        self.assertIn("made every part of this page except broken (", run.made_line(60, 0, failed))
        self.assertIn("A run of 20 minutes made every part of this page (", run.made_line(1200, 0, {}))

    def test_every_part_has_its_figures_expected_and_its_place_on_a_page(self):
        with open(os.path.join(run.FOLDER, "expected.json"), encoding="utf-8") as file:
            expected = run.json.load(file)
        self.assertEqual(set(expected), set(run.PARTS) - run.NOT_QUICK)
        self.assertEqual(set(run.PARTS), set(run.PAPER) | set(run.VALIDATION) | set(run.ENERGY))

    def test_jobs_come_back_in_their_order(self):
        self.assertEqual(sim.at_once([lambda k=k: k for k in range(9)]), list(range(9)))


class Validation(unittest.TestCase):
    def test_what_is_said_to_be_held_has_its_test(self):
        with open(os.path.join(run.ROOT, held.QUICK), encoding="utf-8") as file:
            figures = [name for part in run.json.load(file).values() for name in part]
        for what, _, tests in held.HELD:
            for path, name in tests:
                if path == held.QUICK:
                    self.assertTrue(any(figure.startswith(name) for figure in figures), f"{what}: {name}")
                    continue
                with open(os.path.join(run.ROOT, path), encoding="utf-8") as file:
                    self.assertIn(f"cmocka_unit_test({name})", file.read(), what)

    def test_lines_of_the_test_of_equilibria_are_read(self):
        line = ("[ RUN ] x\ntwist_stvk_nu30                  displacement 3.2e-09, force 1.8e-08 of the same mesh's; mesh "
                "against a converged one +36.1 %; 0.4 s\n")
        self.assertEqual(elements.LINE.findall(line), [("twist_stvk_nu30", "3.2e-09", "1.8e-08", "+36.1")])

    def test_the_matrix_of_presses_is_read_whole_or_not_at_all(self):
        lines = ("[ RUN      ] nothing_crosses\n"
                 "ball of 0.25 mm    sheet   4 mm, 1.50 m/s: held,  0.049 N, 0.000 mm deep\n"
                 "hook of 1.5 mm     slab    2 mm, 0.10 m/s: CROSSED, 12.345 N, 0.671 mm deep, points left out: TOO DEEP\n")
        presses, failed = contact.read_matrix(lines + "2 of 192 presses, 1 failed\n")
        self.assertEqual(presses, [("ball of 0.25 mm", "sheet", 4, False, 0), ("hook of 1.5 mm", "slab", 2, True, 0.671)])
        self.assertEqual(failed, 1)
        for cut_short in (lines, lines + "3 of 192 presses, 1 failed\n", "0 of 192 presses, 0 failed\n"):
            with self.assertRaises(ValueError):
                contact.read_matrix(cut_short)

    def test_what_is_said_of_contact_says_so_where_it_is_not_as_asked(self):
        self.assertEqual(contact.judged(0.05, 0.1), "5.0%, within the 10% that is asked")
        self.assertEqual(contact.judged(0.11, 0.1), "11.0%, above the 10% that is asked")
        still, moved = ([{"force_n": force, "solved_n": force} for force in forces] for forces in ((1, 1), (1, 1.5)))
        self.assertEqual(contact.slides_said({2: still, 4: still}), "All these ranges are within their limits.")
        self.assertEqual(contact.slides_said({2: moved, 4: still}),
                         "At 2 cells a patch the range is above its limit: the solution of such a mesh changes by 40.0%.")
        case = contact.COSTS[0]
        self.assertIn("0.60 ms, within", contact.cost_said({case: {"in_ms": 1.596, "away_ms": 1}}))
        self.assertIn("0.70 ms, above", contact.cost_said({case: {"in_ms": 1.7, "away_ms": 1}}))
        held, crossed = (("ball of 1 mm", "sheet", 4, through, 0.2) for through in (False, True))
        self.assertIn("**none** crossed. Of 1 balls 1", contact.crossing_said([held], 0))
        self.assertIn("**1** crossed, and 1 failed", contact.crossing_said([held, crossed], 1))
        self.assertIn("held at all", contact.narrow_said([{"least_n": 1}, {"least_n": 0.1}]))
        self.assertIn("at 1 of them", contact.narrow_said([{"least_n": 1}, {"least_n": 0}]))
        press = {"vertex_depth_m": 0, "face_depth_m": 9e-5, "left_out": 0, "least_n": 1, "most_n": 1}
        ball = contact.BALLS[0]
        said = contact.rest_said({(ball, 2): [press]}).replace("\n", " ")
        self.assertIn("No face is deeper than the limit; the deepest face is 0.09 mm deep", said)
        deep = press | {"face_depth_m": 2e-4, "left_out": 3, "most_n": 3}
        said = contact.rest_said({(ball, 2): [press], (ball, 4): [deep]}).replace("\n", " ")
        self.assertIn("in 1 of 2", said)
        self.assertIn("The force on a ball at rest changes by 100.0% at most (ball of 1.5 mm, cells of 4 mm)", said)
        self.assertIn("At 1 of 2 places touching tissue had no contact constraint", said)

    def test_the_closed_form_is_hot_at_the_ball_and_comes_to_r_over_r(self):
        self.assertEqual(heat.exact_c(heat.BALL_M, 1), heat.HOT_C)
        half = (heat.HOT_C + heat.AMBIENT_C) / 2
        self.assertAlmostEqual(heat.exact_c(2 * heat.BALL_M, 1e11), half, delta=1e-3)
        self.assertAlmostEqual(heat.exact_c(1, 1), heat.AMBIENT_C)
        points = [(0.001, 170), (0.004, heat.exact_c(0.004, 1) + 13.3), (0.005, heat.exact_c(0.005, 1) - 1.33)]
        self.assertAlmostEqual(heat.worst(points, 1), 0.1)

    def test_the_volume_of_a_cell(self):
        class Rest:
            position_m = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)]
        self.assertAlmostEqual(cuts.volume(Rest, (0, 1, 2, 3)), 1)

    def test_a_thinned_line_keeps_both_ends(self):
        line = [(k, 0) for k in range(1000)]
        self.assertEqual(plots.thinned(line)[0], line[0])
        self.assertEqual(plots.thinned(line)[-1], line[-1])
        self.assertLessEqual(len(plots.thinned(line)), 201)
        self.assertEqual(plots.thinned(line[:9]), line[:9])

    def test_pictures_are_named_by_their_cut(self):
        self.assertEqual(viewer.file_stem("fascia, frayed"), "figure-7-fascia-frayed")


class PublishedMeasurements(unittest.TestCase):
    def test_a_value_counts_within_a_factor_of_two_and_a_temperature_by_its_rise(self):
        self.assertTrue(measured.Value("", 10, 20).within())
        self.assertTrue(measured.Value("", 10, 5).within())
        self.assertFalse(measured.Value("", 10, 20.1).within())
        self.assertFalse(measured.Value("", 10, 0).within())
        self.assertTrue(measured.Value("", 60, 55, above=40).within())
        self.assertFalse(measured.Value("", 60, 49, above=40).within())

    def test_a_measurement_holds_where_all_its_values_do(self):
        near, far = measured.Value("near", 1, 1), measured.Value("far", 1, 3)
        self.assertTrue(measured.Measured("1", "", "", True, [near]).holds())
        self.assertFalse(measured.Measured("1", "", "", True, [near, far]).holds())
        said = measured.verdict([measured.Measured("1", "", "", True, [near]), measured.Measured("2", "", "", True, [far]),
                                 measured.Measured("3", "", "", True, []), measured.Measured("4", "", "", False, [near])])
        self.assertIn("Of the 3 measurements that should be within a factor of two, 1 are: 1.", said)

    def test_each_term_is_taken_away_alone(self):
        whole = measured.with_jaws_of(0.5)
        changes = {"boiling": {"boiling"}, "blade": {"upper_j_k", "lower_j_k"}, "perfusion": {"perfusion"}, "contact": {"groove_mm"}}
        self.assertEqual(set(changes), set(measured.SETUPS["terms"]))
        for term, names in changes.items():
            less = measured.without(whole, term)
            self.assertEqual({name for name in whole if whole[name] != less[name]}, names)

    def test_every_number_of_a_set_up_has_its_source(self):
        for group, numbers in measured.SETUPS.items():
            for name, pair in numbers.items() if isinstance(numbers, dict) else ():
                self.assertEqual((len(pair), isinstance(pair[1], str) and len(pair[1]) > 0), (2, True), f"{group}.{name}")


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
