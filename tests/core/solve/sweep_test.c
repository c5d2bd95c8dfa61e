// SPDX-License-Identifier: GPL-3.0-or-later
// The packed sweeps against the factor from which they are packed: for every precision, instruction
// set and number of threads, before and after cuts.
#include <string.h>

#include "core/rig/solve_scenes.h"

// Forms of the panels' entries, with the largest relative error of a solve (CLOSE). The measured
// rounding of a well-conditioned solve is 1e-15 with doubles, and at worst 4e-7 with floats and
// 7e-5 with narrow entries (both for fascia). CLOSE is larger, because other processors may add in
// another order.
typedef enum form { DOUBLES, FLOATS, NARROW, FORM_COUNT } form;
static const char *const FORM_NAMES[] = {"doubles", "floats", "narrow"};
static const double CLOSE[] = {1e-13, 5e-6, 3e-4};
static const double REFINED = 1e-10; // largest relative error after three increments
static const char *const TIERS[] = {"baseline", "avx2", "avx512"};

static void make(rig *r, int scene, form panels, const char *tier, int32_t threads)
{
	rig_begin(r);
	r->scene->precision = panels == DOUBLES ? CAU_PRECISION_DOUBLE : CAU_PRECISION_SINGLE;
	solve_scenes[scene].add(r);
	rig_build(r, tier, threads);
	if (panels == NARROW)
		r->solver.whole_panels = 0;
	rig_factor(r);
	assert_int_equal(r->solver.sweep.narrow, panels == NARROW);
}

static int has_tier(int single, const char *tier)
{
	return strcmp(cau_kernels_choose(single, tier)->instruction_set, tier) == 0;
}

static double *load(rig *r)
{
	uint64_t random = 91;
	size_t n = 3 * (size_t)r->tissue.vertex_count;
	double *b = cau_arena_array(&r->arena, n, sizeof(double));
	for (size_t i = 0; i < n; i++)
		b[i] = r->tissue.pinned[i / 3] ? 0 : (float)random_between(&random, -1, 1);
	return b;
}

static void cut_some(rig *r, uint64_t tick, int count)
{
	uint64_t random = 92 + tick;
	for (int i = 0; i < count; i++) {
		int kind = (int)random_between(&random, 0, CAU_ELEMENT_KINDS);
		int32_t most = cau_tissue_element_count(&r->tissue, kind);
		int32_t e = (int32_t)random_between(&random, 0, most);
		if (most && r->dissection.alive.element[kind][e])
			rig_remove(r, kind, e, tick);
	}
	rig_update_factor(r, tick);
}

static void test_agree_with_the_factor(void **state)
{
	(void)state;
	for (int s = 0; s < SOLVE_SCENES; s++)
		for (form panels = 0; panels < FORM_COUNT; panels++)
			for (int t = 0; t < 3; t++) {
				if (!has_tier(panels != DOUBLES, TIERS[t]))
					continue;
				rig r;
				make(&r, s, panels, TIERS[t], 1);
				size_t n = 3 * (size_t)r.tissue.vertex_count;
				double *b = load(&r), *x = load(&r), *expected = load(&r);
				solve_by_factor(&r, b, expected);
				solve_by_sweep(&r, b, x);
				double off = rig_difference(x, expected, n);
				if (!(off < CLOSE[panels]))
					fail_msg("%s, %s, %s: off by %g", solve_scenes[s].name, TIERS[t],
					         FORM_NAMES[panels], off);
				for (size_t i = 0; i < n; i++)
					assert_true(!r.tissue.pinned[i / 3] || x[i] == 0);
				rig_finish(&r);
			}
}

// Computes r = b - A x, with A dense.
static void residual(const double *a, const double *b, const double *x, size_t n, double *r)
{
	memcpy(r, b, 3 * n * sizeof *r);
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < n; j++)
			for (size_t c = 0; c < 3; c++)
				r[3 * i + c] -= a[i * n + j] * x[3 * j + c];
}

// Each increment corrects the error of the increments before, so rounding in the panels does not
// remain in the result.
static void test_increments_refine(void **state)
{
	(void)state;
	for (int s = 0; s < SOLVE_SCENES; s++)
		for (int t = 0; t < 3; t++) {
			if (!has_tier(1, TIERS[t]))
				continue;
			rig r;
			make(&r, s, NARROW, TIERS[t], 1);
			size_t n = (size_t)r.tissue.vertex_count;
			double *b = load(&r), *x = load(&r), *d = load(&r), *rest = load(&r),
				   *expected = load(&r);
			double *a = cau_arena_array(&r.arena, n * n, sizeof *a);
			solve_dense_matrix(&r, a);
			solve_by_factor(&r, b, expected);
			memset(x, 0, 3 * n * sizeof *x);
			for (int k = 0; k < 3; k++) {
				residual(a, b, x, n, rest);
				solve_by_sweep(&r, rest, d);
				for (size_t i = 0; i < 3 * n; i++)
					x[i] += d[i];
			}
			double off = rig_difference(x, expected, 3 * n);
			if (!(off < REFINED))
				fail_msg("%s, %s: off by %g", solve_scenes[s].name, TIERS[t], off);
			rig_finish(&r);
		}
}

// Results are bit for bit the same for any number of threads, before and after cuts.
static void test_threads_change_nothing(void **state)
{
	(void)state;
	static const int32_t threads[] = {1, 2, 3, 7};
	for (int s = 0; s < SOLVE_SCENES; s++)
		for (form panels = 0; panels < FORM_COUNT; panels++) {
			rig first;
			make(&first, s, panels, NULL, 1);
			size_t n = 3 * (size_t)first.tissue.vertex_count;
			double *b = load(&first), *expected[2] = {load(&first), load(&first)};
			solve_by_sweep(&first, b, expected[0]);
			cut_some(&first, 0, 8);
			solve_by_sweep(&first, b, expected[1]);
			for (size_t k = 1; k < sizeof threads / sizeof *threads; k++) {
				rig r;
				make(&r, s, panels, NULL, threads[k]);
				double *x = load(&r);
				solve_by_sweep(&r, b, x);
				assert_memory_equal(x, expected[0], n * sizeof(double));
				cut_some(&r, 0, 8);
				solve_by_sweep(&r, b, x);
				assert_memory_equal(x, expected[1], n * sizeof(double));
				rig_finish(&r);
			}
			rig_finish(&first);
		}
}

// Packing only the supernodes that downdates changed gives the same bits as packing all supernodes.
static void test_partial_packing_is_full_packing(void **state)
{
	(void)state;
	static const int scenes[] = {0, 1, 2, 5};
	for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++)
		for (form form_of = 0; form_of < FORM_COUNT; form_of++) {
			rig r;
			make(&r, scenes[s], form_of, NULL, 1);
			cau_sweep *sweep = &r.solver.sweep;
			size_t size = sweep->kernels->vectors->real_bytes;
			size_t panel = (size_t)sweep->panel_entries * cau_sweep_entry_bytes(sweep);
			for (uint64_t tick = 0; tick < 12; tick++)
				cut_some(&r, tick, 6);
			assert_true(r.update.operation_count > 10);
			void *panels = cau_arena_copy(&r.arena, sweep->panel, panel, 1);
			void *pivots = cau_arena_copy(&r.arena, sweep->d_inverse, (size_t)sweep->n, size);
			void *scale = cau_arena_copy(&r.arena, sweep->scale, (size_t)sweep->n, size);
			cau_sweep_pack(sweep, r.solver.factor);
			assert_memory_equal(sweep->panel, panels, panel);
			assert_memory_equal(sweep->d_inverse, pivots, (size_t)sweep->n * size);
			assert_memory_equal(sweep->scale, scale, (size_t)sweep->n * size);
			rig_finish(&r);
		}
}

// Supernodes cover every column once. Tasks are disjoint, and all descendants of a task's supernode
// are in the task.
static void test_shape(void **state)
{
	(void)state;
	for (int s = 0; s < SOLVE_SCENES; s++) {
		rig r;
		make(&r, s, DOUBLES, NULL, 1);
		const cau_sweep *sweep = &r.solver.sweep;
		int32_t next = 0, above = 0;
		for (int32_t k = 0; k < sweep->supernode_count; k++) {
			const cau_supernode *node = &sweep->supernode[k];
			assert_int_equal(node->first, next);
			assert_true(node->columns > 0);
			next += node->columns;
			above += node->task < 0;
			if (node->parent < 0)
				continue;
			assert_true(node->parent > k);
			int32_t over = sweep->supernode[node->parent].task;
			assert_true(node->task < 0 ? over < 0 : over < 0 || over == node->task);
		}
		assert_int_equal(next, sweep->n);
		assert_int_equal(above, sweep->top_node_count);
		assert_true(sweep->task_count >= 1 && sweep->task_count <= CAU_SWEEP_TASKS);
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_agree_with_the_factor),
		cmocka_unit_test(test_increments_refine),
		cmocka_unit_test(test_threads_change_nothing),
		cmocka_unit_test(test_partial_packing_is_full_packing),
		cmocka_unit_test(test_shape),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
