// SPDX-License-Identifier: GPL-3.0-or-later
// Updates of the factor after cuts: few elements by downdates, many by a new factor in the
// background. All waits are bounded, and every run gives the same result.
#include <string.h>

#include "core/rig/solve_scenes.h"

// Largest relative difference between the solutions of a downdated and a fresh factor. With the
// slab's stiffest element and its lightest vertex, 1e-13 w |G|^2 dt^2 / m is slightly larger than
// 1e-10.
static const double DOWNDATE_TOLERANCE = 2e-10;
// longest simulated time, s, that a removed element may stay in the factor
static const double WAIT_MOST_S = 0.050;

enum { SLAB = 1, LAYERS = 5 };

typedef struct cutter {
	rig r;
	uint64_t random, tick;
	double *load, *solution;
	size_t reals;
} cutter;

static void make(cutter *c, int scene, int precision, int32_t threads, double step_s)
{
	memset(c, 0, sizeof *c);
	c->random = 101;
	rig_begin(&c->r);
	c->r.scene->precision = precision;
	c->r.scene->step_s = step_s;
	solve_scenes[scene].add(&c->r);
	rig_build(&c->r, NULL, threads);
	rig_factor(&c->r);
	c->reals = 3 * (size_t)c->r.tissue.vertex_count;
	c->load = cau_arena_array(&c->r.arena, c->reals, sizeof(double));
	c->solution = cau_arena_array(&c->r.arena, c->reals, sizeof(double));
	for (size_t i = 0; i < c->reals; i++)
		c->load[i] = c->r.tissue.pinned[i / 3] ? 0 : (float)random_between(&c->random, -1, 1);
}

// Removes up to `count` live elements and computes one tick of the update. Returns how many it
// removed.
static int cut(cutter *c, int count)
{
	int removed = 0;
	for (int tries = 0; tries < 50 * count && removed < count; tries++) {
		int kind = (int)random_between(&c->random, 0, CAU_ELEMENT_KINDS);
		int32_t most = cau_tissue_element_count(&c->r.tissue, kind);
		int32_t e = (int32_t)random_between(&c->random, 0, most);
		if (!most || !c->r.dissection.alive.element[kind][e])
			continue;
		rig_remove(&c->r, kind, e, c->tick);
		removed++;
	}
	rig_update_factor(&c->r, c->tick++);
	return removed;
}

// Computes the solution of a rig whose factor is computed from the same live elements.
static void solve_fresh(cutter *c, int precision, int scene, double *out)
{
	cutter fresh;
	make(&fresh, scene, precision, 1, c->r.scene->step_s);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		memcpy(fresh.r.dissection.alive.element[kind], c->r.dissection.alive.element[kind],
		       (size_t)cau_tissue_element_count(&c->r.tissue, kind));
	assert_int_equal(cau_matrix_update_refactor(&fresh.r.update, &fresh.r.dissection.alive, NULL),
	                 CAU_OK);
	solve_by_sweep(&fresh.r, c->load, out);
	rig_finish(&fresh.r);
}

static void test_a_few_are_downdated_at_once(void **state)
{
	(void)state;
	cutter c;
	make(&c, SLAB, CAU_PRECISION_DOUBLE, 1, 1.0 / 60);
	double *fresh = cau_arena_array(&c.r.arena, c.reals, sizeof(double));
	for (int tick = 0; tick < 8; tick++) {
		cut(&c, 4);
		assert_int_equal(c.r.update.waiting_count, 0);
		assert_int_equal(c.r.update.refactorisations, 0);
		solve_by_sweep(&c.r, c.load, c.solution);
		solve_fresh(&c, CAU_PRECISION_DOUBLE, SLAB, fresh);
		double off = rig_difference(c.solution, fresh, c.reals);
		assert_true(off > 0 && off < DOWNDATE_TOLERANCE);
	}
	assert_int_equal(c.r.update.operation_count, 32);
	assert_int_equal(c.r.update.longest_wait, 0);
	rig_finish(&c.r);
}

// If a tick parts more than a few elements, the next ticks downdate some of them. Two ticks later
// none waits, and the factor agrees with a fresh one.
static void test_more_are_shared_with_the_next_ticks(void **state)
{
	(void)state;
	cutter c;
	make(&c, SLAB, CAU_PRECISION_DOUBLE, 1, 1.0 / 60);
	double *fresh = cau_arena_array(&c.r.arena, c.reals, sizeof(double));
	for (int round = 0; round < 3; round++) {
		cut(&c, 12);
		assert_in_range(c.r.update.waiting_count, 1, 6);
		cut(&c, 0);
		assert_in_range(c.r.update.waiting_count, 0, 2);
		cut(&c, 0);
		assert_int_equal(c.r.update.waiting_count, 0);
		solve_by_sweep(&c.r, c.load, c.solution);
		solve_fresh(&c, CAU_PRECISION_DOUBLE, SLAB, fresh);
		assert_true(rig_difference(c.solution, fresh, c.reals) < DOWNDATE_TOLERANCE);
	}
	// the same number of elements is cut in each of several ticks
	for (int tick = 0; tick < 10; tick++)
		cut(&c, 8);
	cut(&c, 0);
	cut(&c, 0);
	assert_int_equal(c.r.update.waiting_count, 0);
	assert_int_equal(c.r.update.refactorisations, 0);
	assert_in_range(c.r.update.longest_wait, 1, 2);
	rig_finish(&c.r);
}

// After a burst of cuts, a new factor is computed. It comes into use one sixtieth of a second
// later, not before. It is bit for bit the factor that is computed from the same elements.
static void test_a_burst_swaps_in_a_new_factor(void **state)
{
	(void)state;
	static const double steps[] = {1.0 / 60, 1.0 / 240};
	for (size_t k = 0; k < 2; k++) {
		cutter c;
		make(&c, SLAB, CAU_PRECISION_SINGLE, 1, steps[k]);
		double *before = cau_arena_array(&c.r.arena, c.reals, sizeof(double));
		double *fresh = cau_arena_array(&c.r.arena, c.reals, sizeof(double));
		solve_by_sweep(&c.r, c.load, before);
		assert_int_equal(cut(&c, 300), 300);
		solve_fresh(&c, CAU_PRECISION_SINGLE, SLAB, fresh);
		int ticks = (int)(steps[0] / steps[k] + 0.5);
		for (int t = 0; t < ticks; t++) {
			assert_int_equal(c.r.update.refactorisations, 0);
			assert_int_equal(c.r.update.waiting_count, 300);
			solve_by_sweep(&c.r, c.load, c.solution);
			assert_memory_equal(c.solution, before, c.reals * sizeof(double));
			cut(&c, 0);
		}
		assert_int_equal(c.r.update.refactorisations, 1);
		assert_int_equal(c.r.update.waiting_count, 0);
		solve_by_sweep(&c.r, c.load, c.solution);
		assert_memory_equal(c.solution, fresh, c.reals * sizeof(double));
		cau_background_wait(c.r.update.background);
		assert_null(c.r.update.next_panels.panel); // the second set of panels is freed
		rig_finish(&c.r);
	}
}

// Without memory for a second set of panels, the swap packs in place and gives the same bits.
static void test_a_swap_without_a_second_set(void **state)
{
	(void)state;
	cutter c;
	make(&c, SLAB, CAU_PRECISION_SINGLE, 1, 1.0 / 60);
	double *fresh = cau_arena_array(&c.r.arena, c.reals, sizeof(double));
	assert_int_equal(cut(&c, 300), 300);
	solve_fresh(&c, CAU_PRECISION_SINGLE, SLAB, fresh);
	cau_background_wait(c.r.update.background);
	assert_non_null(c.r.update.next_panels.panel);
	cau_sweep_finish_panels(&c.r.update.next_panels);
	cut(&c, 0);
	assert_int_equal(c.r.update.refactorisations, 1);
	solve_by_sweep(&c.r, c.load, c.solution);
	assert_memory_equal(c.solution, fresh, c.reals * sizeof(double));
	rig_finish(&c.r);
}

// Elements that are cut while a factor is being computed are handled after the swap, by downdates
// or by another factor.
static void test_cuts_during_the_making_are_not_lost(void **state)
{
	(void)state;
	cutter c;
	make(&c, LAYERS, CAU_PRECISION_DOUBLE, 1, 1.0 / 60);
	double *fresh = cau_arena_array(&c.r.arena, c.reals, sizeof(double));
	cut(&c, 100);
	cut(&c, 5); // the swap, then five downdates
	cut(&c, 100);
	cut(&c, 100); // the swap, then another new factor
	for (int tick = 0; tick < 3; tick++)
		cut(&c, 0);
	assert_int_equal(c.r.update.waiting_count, 0);
	assert_false(c.r.update.making);
	solve_by_sweep(&c.r, c.load, c.solution);
	solve_fresh(&c, CAU_PRECISION_DOUBLE, LAYERS, fresh);
	// 10 MPa next to 5 kPa make rounding larger
	assert_true(rig_difference(c.solution, fresh, c.reals) < 1e-7);
	rig_finish(&c.r);
}

static void test_no_element_waits_long(void **state)
{
	(void)state;
	// rates below, at and above the number that downdates can handle in a tick
	static const int rates[] = {3, 7, 12, 13, 14, 16, 17, 24, 25, 40};
	for (size_t k = 0; k < sizeof rates / sizeof *rates; k++) {
		cutter c;
		make(&c, SLAB, CAU_PRECISION_SINGLE, 1, 1.0 / 60);
		for (int tick = 0; tick < 40; tick++) {
			cut(&c, rates[k]);
			assert_true(c.r.update.operation_count <= CAU_DOWNDATES_AT_MOST);
			for (int32_t w = 0; w < c.r.update.waiting_count; w++)
				assert_true((double)(c.tick - c.r.update.waiting[w].tick) / 60 <= WAIT_MOST_S);
		}
		assert_true((double)c.r.update.longest_wait / 60 <= WAIT_MOST_S);
		rig_finish(&c.r);
	}
}

// After 2,000 downdates the factor is replaced by a canonical one, and the count starts again.
static void test_a_worn_factor_is_replaced(void **state)
{
	(void)state;
	cutter c;
	make(&c, SLAB, CAU_PRECISION_SINGLE, 1, 1.0 / 60);
	double *fresh = cau_arena_array(&c.r.arena, c.reals, sizeof(double));
	int32_t total = 0;
	while (!c.r.update.refactorisations) {
		total += cut(&c, 10);
		assert_true(total < CAU_DOWNDATES_AT_MOST + 40);
		assert_true(c.r.update.operation_count <= CAU_DOWNDATES_AT_MOST);
	}
	assert_true(total > CAU_DOWNDATES_AT_MOST);
	for (int tick = 0; tick < 3; tick++)
		cut(&c, 0);
	assert_int_equal(c.r.update.waiting_count, 0);
	assert_true(c.r.update.operation_count < 40);
	solve_by_sweep(&c.r, c.load, c.solution);
	solve_fresh(&c, CAU_PRECISION_SINGLE, SLAB, fresh);
	assert_true(rig_difference(c.solution, fresh, c.reals) < 1e-5); // the panels are in float
	rig_finish(&c.r);
}

// The same cuts give the same bits at every tick, whichever thread is faster.
static void test_every_run_is_the_same(void **state)
{
	(void)state;
	static const int script[] = {4, 0, 120, 3, 7, 0, 60, 60, 60, 0, 2, 1};
	cutter a, b;
	make(&a, LAYERS, CAU_PRECISION_SINGLE, 1, 1.0 / 240);
	make(&b, LAYERS, CAU_PRECISION_SINGLE, 3, 1.0 / 240);
	for (size_t k = 0; k < sizeof script / sizeof *script; k++) {
		cut(&a, script[k]);
		if (a.r.update.making)
			cau_background_wait(a.r.update.background); // the factor of `a` is ready early
		cut(&b, script[k]);
		solve_by_sweep(&a.r, a.load, a.solution);
		solve_by_sweep(&b.r, b.load, b.solution);
		assert_memory_equal(a.solution, b.solution, a.reals * sizeof(double));
		assert_int_equal(a.r.update.waiting_count, b.r.update.waiting_count);
	}
	assert_true(a.r.update.refactorisations > 0);
	rig_finish(&a.r);
	rig_finish(&b.r);
}

// All elements are removed. The matrix has only masses left.
static void test_nothing_left(void **state)
{
	(void)state;
	cutter c;
	make(&c, SLAB, CAU_PRECISION_DOUBLE, 1, 1.0 / 60);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t e = 0; e < cau_tissue_element_count(&c.r.tissue, kind); e++)
			rig_remove(&c.r, kind, e, 0);
	for (int tick = 0; tick < 3; tick++)
		cut(&c, 0);
	solve_by_sweep(&c.r, c.load, c.solution);
	for (size_t i = 0; i < c.reals; i++) {
		double expected =
			c.load[i] * c.r.solver.step_s * c.r.solver.step_s / c.r.tissue.mass[i / 3];
		// the tolerance is the rounding of one or two divisions
		assert_near(c.solution[i], expected, 1e-14 * fabs(expected));
	}
	rig_finish(&c.r);
}

// The diagonal system has no factor. Its diagonal is updated at once.
static void test_diagonal_system(void **state)
{
	(void)state;
	cutter c;
	memset(&c, 0, sizeof c);
	c.random = 5;
	rig_begin(&c.r);
	c.r.scene->solver = CAU_SOLVER_DIAGONAL;
	solve_scenes[SLAB].add(&c.r);
	rig_build(&c.r, NULL, 1);
	rig_factor(&c.r);
	size_t n = (size_t)c.r.tissue.vertex_count;
	double *followed = cau_arena_array(&c.r.arena, n, sizeof(double));
	cut(&c, 50);
	assert_int_equal(c.r.update.waiting_count, 0);
	memcpy(followed, c.r.solver.system.diagonal, n * sizeof(double));
	cau_system_assemble_diagonal(&c.r.solver.system, &c.r.tissue, &c.r.dissection.alive,
	                             c.r.solver.step_s);
	assert_memory_equal(followed, c.r.solver.system.diagonal, n * sizeof(double));
	rig_finish(&c.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_a_few_are_downdated_at_once),
		cmocka_unit_test(test_more_are_shared_with_the_next_ticks),
		cmocka_unit_test(test_a_burst_swaps_in_a_new_factor),
		cmocka_unit_test(test_a_swap_without_a_second_set),
		cmocka_unit_test(test_cuts_during_the_making_are_not_lost),
		cmocka_unit_test(test_no_element_waits_long),
		cmocka_unit_test(test_a_worn_factor_is_replaced),
		cmocka_unit_test(test_every_run_is_the_same),
		cmocka_unit_test(test_nothing_left),
		cmocka_unit_test(test_diagonal_system),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
