// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that exactly the crossing vertices are exempted. One sheet is pushed through the other at
// random. Each exempt vertex must be a corner of an edge that pierces a face, or of that face.
#include "core/collide/sheets.h"

#include <stdlib.h>

static const double THICKNESS_M = 1e-3;

// Marks the corners of all crossings, found by testing every edge against every face. Returns the
// number of crossings.
static int mark(const sheets *s, uint8_t *expected)
{
	const cau_tissue *t = &s->r.tissue;
	int count = 0;
	for (int32_t e = 0; e < t->edges.edge_count; e++)
		for (int32_t f = 0; f < t->triangle_count; f++) {
			const int32_t *edge = t->edges.vertex + 2 * (size_t)e;
			const int32_t *face = t->triangle + 3 * (size_t)f;
			if (!sheets_pierce(s->x, edge, face))
				continue;
			expected[edge[0]] = expected[edge[1]] = 1;
			expected[face[0]] = expected[face[1]] = expected[face[2]] = 1;
			count++;
		}
	return count;
}

static void what_crosses_is_exempt(void **state)
{
	(void)state;
	enum { WAYS = 20 };
	sheets s;
	sheets_begin(&s, THICKNESS_M, 0, 2e-3);
	size_t n = (size_t)s.r.tissue.vertex_count;
	uint8_t *expected = malloc(n);
	assert_non_null(expected);
	int crossings = 0;
	for (int way = 0; way < WAYS; way++) {
		memset(expected, 0, n);
		memset(s.collide.exempt, 0, n);
		sheets_shake(&s, 1e-3);
		crossings += mark(&s, expected);
		cau_collide_exempt_crossed(&s.collide, s.x);
		assert_memory_equal(s.collide.exempt, expected, n);
	}
	assert_true(crossings > 100);
	free(expected);
	rig_finish(&s.r);
}

static void sheets_apart_cross_nothing(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, THICKNESS_M, 0, 1e-4);
	size_t n = (size_t)s.r.tissue.vertex_count;
	memset(s.collide.exempt, 0, n);
	cau_collide_exempt_crossed(&s.collide, s.x);
	for (size_t v = 0; v < n; v++)
		assert_false(s.collide.exempt[v]);
	rig_finish(&s.r);
}

// A search for crossings is needed when a vertex takes part in contact again, and in the first
// tick, when no earlier state is known.
static void it_is_looked_for_where_something_touches_again(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, THICKNESS_M, 0, 2e-3);
	assert_true(cau_collide_touches_again(&s.collide));
	cau_collide_begin(&s.collide, s.pool, s.x);
	assert_false(cau_collide_touches_again(&s.collide));
	s.collide.exempt[3] = 1; // jaws close
	assert_false(cau_collide_touches_again(&s.collide));
	cau_collide_begin(&s.collide, s.pool, s.x);
	s.collide.exempt[3] = 0; // jaws open
	assert_true(cau_collide_touches_again(&s.collide));
	cau_collide_begin(&s.collide, s.pool, s.x);
	cau_collide_let_go(&s.collide, 4);
	assert_true(s.collide.exempt[4]);
	s.collide.exempt[4] = 0; // the next tick
	assert_true(cau_collide_touches_again(&s.collide));
	rig_finish(&s.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_crosses_is_exempt),
		cmocka_unit_test(sheets_apart_cross_nothing),
		cmocka_unit_test(it_is_looked_for_where_something_touches_again),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
