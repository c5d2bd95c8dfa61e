// SPDX-License-Identifier: GPL-3.0-or-later
// Tests random ignition temperatures: their statistics, their limits, and that they depend only on
// the seed, the layer and the edge. In bundles they depend on the position instead of the edge.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/tool/tools.h"
#include "heat/exposure.h"

enum { DRAWS = 100000 };
static const double MEAN_C = 172, SPREAD_C = 17; // mean and spread of fascia

static void test_statistics(void **state)
{
	(void)state;
	// The standard error of a mean of the draws. A correct draw is outside five standard errors
	// with a probability of 1e-6. Draws are limited to 3 standard deviations, which lowers their
	// spread by 0.2 %.
	const double error = SPREAD_C / sqrt(DRAWS);
	double sum = 0, squares = 0, product = 0, previous = 0, beyond = 0;
	for (int32_t edge = 0; edge < DRAWS; edge++) {
		double g = (cau_ignition_of(MEAN_C, SPREAD_C, 7, 2, edge) - MEAN_C) / SPREAD_C;
		sum += g;
		squares += g * g;
		product += g * previous;
		previous = g;
		beyond += fabs(g) > 1.959964;
		assert_true(fabs(g) <= 3 + 1e-12);
	}
	assert_near(sum / DRAWS * SPREAD_C, 0, 5 * error);
	assert_near(sqrt(squares / DRAWS) * SPREAD_C, SPREAD_C, 5 * error / sqrt(2) + 0.002 * SPREAD_C);
	assert_near(product / DRAWS, 0, 5 / sqrt(DRAWS));                 // neighbours are independent
	assert_near(beyond / DRAWS, 0.05, 5 * sqrt(0.05 * 0.95 / DRAWS)); // the distribution is normal
}

static void test_depends_on_its_arguments_alone(void **state)
{
	(void)state;
	double first = cau_ignition_of(MEAN_C, SPREAD_C, 7, 2, 100);
	cau_ignition_of(MEAN_C, SPREAD_C, 8, 3, 101);
	assert_true(cau_ignition_of(MEAN_C, SPREAD_C, 7, 2, 100) == first);
	assert_true(cau_ignition_of(MEAN_C, SPREAD_C, 8, 2, 100) != first);
	assert_true(cau_ignition_of(MEAN_C, SPREAD_C, 7, 3, 100) != first);
	assert_true(cau_ignition_of(MEAN_C, SPREAD_C, 7, 2, 101) != first);
	assert_true(cau_ignition_of(MEAN_C, SPREAD_C, 7, 100, 2) != first);
	assert_true(cau_ignition_of(MEAN_C, 0, 7, 2, 100) == MEAN_C);
}

static void test_cut(void **state)
{
	(void)state;
	int at_floor = 0, at_cut = 0;
	for (int32_t edge = 0; edge < DRAWS; edge++) {
		double wide = cau_ignition_of(MEAN_C, 10 * MEAN_C, 7, 0, edge);
		assert_true(wide >= 0.1 * MEAN_C);
		at_floor += wide == 0.1 * MEAN_C;
		at_cut += wide == MEAN_C + 3 * (10 * MEAN_C);
	}
	assert_true(at_floor > DRAWS / 3); // both limits are reached, the upper limit rarely
	assert_true(at_cut > 0 && at_cut < DRAWS / 300);
}

// ---- bundles
static const double BUNDLE_M = 0.003;

// Returns the draw of layer 2 at a position, with fibres along `fibre`.
static double bundle_draw(uint64_t seed, cau_vec3 place, cau_vec3 fibre)
{
	return (cau_ignition_in_bundles(MEAN_C, SPREAD_C, seed, 2, place, fibre, BUNDLE_M) - MEAN_C) /
	       SPREAD_C;
}

static void test_bundles_are_normal_everywhere(void **state)
{
	(void)state;
	// One position, many seeds: in the middle of a cell of the lattice, and on its corner.
	const cau_vec3 places[] = {{0, 0, 0}, {0.0131, -0.0447, 0.0029}, {0.0015, 0.0015, 0.0015}};
	for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
		double sum = 0, squares = 0;
		for (uint64_t seed = 0; seed < DRAWS; seed++) {
			double g = bundle_draw(seed, places[k], (cau_vec3){0, 1, 0});
			sum += g;
			squares += g * g;
			assert_true(fabs(g) <= 3 + 1e-12);
		}
		assert_near(sum / DRAWS, 0, 5 / sqrt(DRAWS));
		assert_near(sqrt(squares / DRAWS), 1, 5 / sqrt(2 * (double)DRAWS) + 0.002);
	}
}

// Returns the mean product of draws at two positions that are `way` apart: 1 for equal draws, 0 for
// independent draws.
static double likeness(cau_vec3 way, cau_vec3 fibre)
{
	double product = 0;
	for (uint64_t seed = 0; seed < DRAWS; seed++) {
		cau_vec3 from = {0.0007, -0.0161, 0.0022};
		product += bundle_draw(seed, from, fibre) * bundle_draw(seed, cau_add(from, way), fibre);
	}
	return product / DRAWS;
}

static void test_bundles_run_along_the_fibres(void **state)
{
	(void)state;
	const cau_vec3 x = {1, 0, 0}, y = {0, 1, 0}, aside = {BUNDLE_M, 0, 0};
	assert_true(likeness(aside, x) > 0.9); // an eighth of a bundle's length
	assert_true(likeness(aside, y) < 0.6); // the whole width of a bundle
	assert_near(likeness(cau_scale(3, aside), y), 0, 5 / sqrt(DRAWS));
	assert_near(likeness(cau_scale(24, aside), x), 0, 5 / sqrt(DRAWS));
}

static void test_bundles_depend_on_seed_layer_and_place(void **state)
{
	(void)state;
	const cau_vec3 place = {0.01, 0.02, 0.03}, fibre = {1, 0, 0};
	double first = cau_ignition_in_bundles(MEAN_C, SPREAD_C, 7, 2, place, fibre, BUNDLE_M);
	assert_true(cau_ignition_in_bundles(MEAN_C, SPREAD_C, 7, 2, place, fibre, BUNDLE_M) == first);
	assert_true(cau_ignition_in_bundles(MEAN_C, SPREAD_C, 8, 2, place, fibre, BUNDLE_M) != first);
	assert_true(cau_ignition_in_bundles(MEAN_C, SPREAD_C, 7, 3, place, fibre, BUNDLE_M) != first);
	assert_true(cau_ignition_in_bundles(MEAN_C, 0, 7, 2, place, fibre, BUNDLE_M) == MEAN_C);
	assert_true(cau_ignition_in_bundles(MEAN_C, 1e6, 7, 2, place, fibre, BUNDLE_M) >= 0.1 * MEAN_C);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_statistics),
		cmocka_unit_test(test_depends_on_its_arguments_alone),
		cmocka_unit_test(test_cut),
		cmocka_unit_test(test_bundles_are_normal_everywhere),
		cmocka_unit_test(test_bundles_run_along_the_fibres),
		cmocka_unit_test(test_bundles_depend_on_seed_layer_and_place),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
