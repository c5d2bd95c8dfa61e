// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs: every element of a group is in one pair, with a neighbour if one is left.
#include "constraint/elements_internal.h"

#include "core/dissect/cutting.h"

static const int KINDS[] = {CAU_ELEMENT_TRIANGLE, CAU_ELEMENT_TETRAHEDRON};

static void make(rig *r)
{
	rig_begin(r);
	add_all_layers(r);
	rig_build(r, NULL, 1);
}

static int32_t layer_of(const cau_tissue *tissue, int kind, int32_t e)
{
	return kind == CAU_ELEMENT_TRIANGLE ? tissue->triangle_layer[e] : tissue->tetrahedron_layer[e];
}

static const int32_t *vertices_of(const cau_tissue *tissue, int kind, int32_t e)
{
	return kind == CAU_ELEMENT_TRIANGLE ? tissue->triangle + 3 * (size_t)e
	                                    : tissue->tetrahedron + 4 * (size_t)e;
}

// Both elements of a pair list the same shared vertices in the same order. The apexes differ.
static void assert_orders_agree(const cau_tissue *tissue, int kind, int32_t first, int32_t other)
{
	int mine[4], theirs[4], count = kind == CAU_ELEMENT_TRIANGLE ? 3 : 4;
	cau_pair_order(tissue, kind, first, other, first, mine);
	cau_pair_order(tissue, kind, first, other, other, theirs);
	const int32_t *a = vertices_of(tissue, kind, first), *b = vertices_of(tissue, kind, other);
	int seen_mine = 0, seen_theirs = 0;
	for (int i = 0; i < count; i++) {
		seen_mine |= 1 << mine[i];
		seen_theirs |= 1 << theirs[i];
		assert_int_equal(a[mine[i]] == b[theirs[i]], i < count - 1);
	}
	assert_int_equal(seen_mine, (1 << count) - 1);
	assert_int_equal(seen_theirs, (1 << count) - 1);
}

static void test_pairs_are_neighbours_of_one_group(void **state)
{
	(void)state;
	rig r;
	make(&r);
	for (int k = 0; k < 2; k++)
		for (int32_t layer = 0; layer < r.tissue.layer_count; layer++) {
			int kind = KINDS[k];
			int32_t count = cau_tissue_element_count(&r.tissue, kind), members = 0, alone = 0;
			int32_t *partner = cau_arena_array(&r.arena, (size_t)count, sizeof *partner);
			int32_t pairs = cau_pair_elements(&r.tissue, kind, layer, 0, partner);
			for (int32_t e = 0; e < count; e++) {
				if (layer_of(&r.tissue, kind, e) != layer)
					continue;
				members++;
				alone += partner[e] < 0;
				if (partner[e] < 0)
					continue;
				assert_int_equal(partner[partner[e]], e);
				assert_int_equal(layer_of(&r.tissue, kind, partner[e]), layer);
				assert_orders_agree(&r.tissue, kind, e, partner[e]);
			}
			assert_int_equal(2 * pairs, members + alone);
			assert_true(alone <= members / 50); // in a regular mesh few elements have no partner
		}
	rig_finish(&r);
}

// An element without a partner has its vertices in its own order.
static void test_alone(void **state)
{
	(void)state;
	rig r;
	make(&r);
	for (int k = 0; k < 2; k++) {
		int order[4];
		cau_pair_order(&r.tissue, KINDS[k], 0, -1, 0, order);
		for (int i = 0; i < 3 + k; i++)
			assert_int_equal(order[i], i);
	}
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_pairs_are_neighbours_of_one_group),
		cmocka_unit_test(test_alone),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
