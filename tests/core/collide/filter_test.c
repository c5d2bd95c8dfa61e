// SPDX-License-Identifier: GPL-3.0-or-later
// Tests filtered steps. Sheets that move at each other step after step end on the sides on which
// they began. Sheets that part are not changed. If pairs exceed the capacity, nothing moves that
// could cross.
#include "core/collide/sheets.h"

#include <stdlib.h>

enum { STEPS = 60 };

static int crossings(const sheets *s, const double *x)
{
	const cau_tissue *t = &s->r.tissue;
	int count = 0;
	for (int32_t e = 0; e < t->edges.edge_count; e++)
		for (int32_t f = 0; f < t->triangle_count; f++) {
			const int32_t *a = t->edges.vertex + 2 * (size_t)e, *b = t->triangle + 3 * (size_t)f;
			count += sheets_pierce(x, a, b);
		}
	return count;
}

// Expects that every pair keeps a fifth of its distance, or of its thickness if that is less.
static void expect_kept(const sheets *s, const double *before)
{
	for (int32_t k = 0; k < s->collide.pair_count; k++) {
		const cau_collide_pair *pair = &s->collide.pair[k];
		cau_vec3 corner[4];
		cau_collide_corners(pair, before, corner);
		double had = cau_gap_between(pair->kind, corner).distance;
		cau_collide_corners(pair, s->x, corner);
		double has = cau_gap_between(pair->kind, corner).distance;
		assert_true(has >= (1 - 1e-6) * 0.2 * fmin(had, pair->thickness_m));
	}
}

// Makes random steps of several thicknesses, with a drift of the sheets towards each other. Returns
// the number of steps that were held back.
static int throw_together(sheets *s, bool filtered)
{
	int32_t n = s->r.tissue.vertex_count, upper = s->r.tissue.layer[1].first_vertex;
	int held = 0;
	double *before = malloc(3 * (size_t)n * sizeof *before);
	assert_non_null(before);
	cau_collide_begin(&s->collide, s->pool, s->x);
	for (int k = 0; k < STEPS; k++) {
		for (int32_t i = 0; i < 3 * n; i++) {
			s->collide.step[i] = 3e-3 * sheets_draw(s);
			if (i % 3 == 2)
				s->collide.step[i] += i / 3 < upper ? 1e-3 : -1e-3;
		}
		for (int32_t v = 0; v < n; v++)
			if (s->r.fixed[v])
				memset(s->collide.step + 3 * (size_t)v, 0, 3 * sizeof(double));
		held += filtered && cau_collide_filter(&s->collide, s->pool, s->x, false);
		memcpy(before, s->x, 3 * (size_t)n * sizeof *before);
		for (int32_t i = 0; i < 3 * n; i++)
			s->x[i] += s->collide.step[i];
		if (!filtered)
			continue;
		assert_int_equal(crossings(s, s->x), 0);
		expect_kept(s, before);
	}
	free(before);
	return held;
}

static void thrown_sheets_stay_apart(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 5e-4, 0, 2e-3);
	assert_true(throw_together(&s, true) > STEPS / 2);
	rig_finish(&s.r);
	sheets_begin(&s, 5e-4, 0, 2e-3);
	throw_together(&s, false);
	assert_true(crossings(&s, s.x) > 0); // the filter was needed, and crossings would be found
	rig_finish(&s.r);
}

// Every third vertex is fixed. Moving parts back is not enough then, and corners have to stop.
static void what_cannot_make_room_stops(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 2e-3, 0, 1e-3);
	for (int32_t v = 0; v < s.r.tissue.vertex_count; v += 3)
		s.r.fixed[v] = 1;
	assert_true(throw_together(&s, true) > STEPS / 2);
	rig_finish(&s.r);
}

static void parting_sheets_are_let_go(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 5e-4, 0, 2e-4);
	int32_t n = s.r.tissue.vertex_count, upper = s.r.tissue.layer[1].first_vertex;
	cau_collide_begin(&s.collide, s.pool, s.x);
	for (int32_t v = upper; v < n; v++)
		s.collide.step[3 * (size_t)v + 2] = 5e-4;
	assert_false(cau_collide_filter(&s.collide, s.pool, s.x, false));
	for (int32_t v = upper; v < n; v++)
		assert_true(s.collide.step[3 * (size_t)v + 2] == 5e-4);
	rig_finish(&s.r);
}

// A fixed sheet does not give way. The free sheet stops.
static void what_is_fixed_is_not_moved(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 5e-4, 0, 6e-4);
	int32_t n = s.r.tissue.vertex_count, upper = s.r.tissue.layer[1].first_vertex;
	memset(s.r.fixed, 1, (size_t)upper);
	cau_collide_begin(&s.collide, s.pool, s.x);
	for (int32_t v = upper; v < n; v++)
		s.collide.step[3 * (size_t)v + 2] = -9e-4;
	assert_true(cau_collide_filter(&s.collide, s.pool, s.x, false));
	for (int32_t v = 0; v < n; v++) {
		double z = s.collide.step[3 * (size_t)v + 2];
		assert_true(v < upper ? z == 0 : z > -6e-4 && z < 0);
	}
	rig_finish(&s.r);
}

// If the list of pairs is full, the search keeps only pairs that this step needs. These pairs hold
// the step back exactly as all pairs would.
static void scant_room_changes_nothing(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 5e-4, 0, 1.2e-3);
	sheets_shake(&s, 5e-4);
	int32_t n = s.r.tissue.vertex_count, scant = 0;
	double *wanted = malloc(3 * (size_t)n * sizeof *wanted), *held = malloc(3 * (size_t)n * 8);
	for (int32_t i = 0; i < 3 * n; i++)
		wanted[i] =
			// some vertices push others to their limit
			3e-5 * sheets_draw(&s) - (i % 15 == 2) * 9e-4;
	memcpy(s.collide.step, wanted, 3 * (size_t)n * sizeof *wanted);
	cau_collide_begin(&s.collide, s.pool, s.x);
	assert_true(cau_collide_filter(&s.collide, s.pool, s.x, true));
	memcpy(held, s.collide.step, 3 * (size_t)n * sizeof *held);
	int32_t pairs = s.collide.pair_count;
	for (s.collide.most_pairs = pairs; s.collide.cut_short_count == 0; s.collide.most_pairs -= 5) {
		assert_memory_equal(held, s.collide.step, 3 * (size_t)n * sizeof *held);
		scant += s.collide.pair_count < pairs;
		memcpy(s.collide.step, wanted, 3 * (size_t)n * sizeof *wanted);
		s.collide.range.found = false;
		cau_collide_begin(&s.collide, s.pool, s.x);
		cau_collide_filter(&s.collide, s.pool, s.x, true);
	}
	assert_true(scant > 0);
	free(held);
	free(wanted);
	rig_finish(&s.r);
}

static double longest_of(const double *step, int32_t count)
{
	double most = 0;
	for (int32_t v = 0; v < count; v++)
		most = fmax(most, cau_length(cau_vec3_of(step + 3 * (size_t)v)));
	return most;
}

// If the quick check of few vertices accepts a step, the filter does not change that step.
static void what_passes_is_what_is_let_be(void **state)
{
	(void)state;
	enum { PASSES, IS_CHANGED, OUTCOMES };
	sheets s;
	sheets_begin(&s, 5e-4, 0, 6e-4);
	sheets_shake(&s, 2.5e-4);
	int32_t n = s.r.tissue.vertex_count, seen[OUTCOMES] = {0};
	double *wanted = malloc(3 * (size_t)n * sizeof *wanted);
	memset(s.collide.step, 0, 3 * (size_t)n * sizeof *wanted);
	cau_collide_begin(&s.collide, s.pool, s.x);
	for (int k = 0; k < STEPS; k++) {
		for (int32_t i = 0; i < 3 * n; i++)
			wanted[i] = 3e-6 * (1 + k) * sheets_draw(&s);
		double longest = longest_of(wanted, n);
		cau_collide_see(&s.collide, s.pool, s.x);
		bool passes = cau_collide_foresee(&s.collide, longest);
		for (int32_t i = 0; i < 3 * n; i++)
			s.collide.step[i] = NAN; // steps of all other vertices, which must not be read
		for (int32_t i = 0; i < 4 * s.collide.filter.unclear_count; i++) {
			size_t v = (size_t)s.collide.pair[s.collide.filter.unclear[i / 4]].vertex[i % 4];
			memcpy(s.collide.step + 3 * v, wanted + 3 * v, 3 * sizeof *wanted);
		}
		passes = passes && cau_collide_lets_pass(&s.collide, s.x, longest);
		memcpy(s.collide.step, wanted, 3 * (size_t)n * sizeof *wanted);
		cau_collide_stand(&s.collide, s.x);
		bool changed = cau_collide_filter(&s.collide, s.pool, s.x, false);
		assert_true(!passes || !changed);
		seen[PASSES] += passes;
		seen[IS_CHANGED] += changed;
	}
	assert_true(seen[PASSES] > 5 && seen[IS_CHANGED] > 5);
	free(wanted);
	rig_finish(&s.r);
}

static void without_room_nothing_crosses(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 5e-4, 0, 2e-3);
	s.collide.most_pairs = 40; // too few once the sheets are near
	throw_together(&s, true);
	assert_true(s.collide.cut_short_count > 0);
	rig_finish(&s.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(thrown_sheets_stay_apart),
		cmocka_unit_test(what_cannot_make_room_stops),
		cmocka_unit_test(parting_sheets_are_let_go),
		cmocka_unit_test(what_is_fixed_is_not_moved),
		cmocka_unit_test(scant_room_changes_nothing),
		cmocka_unit_test(what_passes_is_what_is_let_be),
		cmocka_unit_test(without_room_nothing_crosses),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
