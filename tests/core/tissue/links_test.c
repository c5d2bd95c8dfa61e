// SPDX-License-Identifier: GPL-3.0-or-later
// Links from each vertex of the upper layer to its nearest vertices of the lower layer, within
// reach.
#include <string.h>

#include "core/rig/rig.h"

static const double REACH_M = 0.012, GAP_M = 0.004;

static void begin(rig *r, double reach, double per_vertex)
{
	rig_begin(r);
	rig_add_slab(r, 9, 7, 2);
	rig_add_sheet(r, 5, 4);
	r->scene->meshes[1].translate_m[2] = GAP_M;
	rig_add_links(r, 1, 0, reach)->link.per_vertex = per_vertex;
}

static double distance(const rig *r, int32_t a, int32_t b)
{
	return cau_length(
		cau_sub(cau_vec3_of(r->tissue.rest + 3 * a), cau_vec3_of(r->tissue.rest + 3 * b)));
}

static void test_the_nearest_within_reach(void **state)
{
	(void)state;
	enum { PER_VERTEX = 3 };
	rig r;
	begin(&r, REACH_M, PER_VERTEX);
	rig_build(&r, NULL, 1);
	const cau_tissue *t = &r.tissue;
	int32_t lower_count = t->layer[0].vertex_count, counted = 0;
	assert_true(t->link_count > 0);
	assert_int_equal(t->layer[2].link_count, t->link_count);
	for (int32_t upper = t->layer[1].first_vertex; upper < t->vertex_count; upper++) {
		double farthest = 0;
		int32_t taken = 0, nearer = 0, reachable = 0;
		for (int32_t k = 0; k < t->link_count; k++)
			if (t->link[2 * k] == upper) {
				assert_in_range(t->link[2 * k + 1], 0, lower_count - 1);
				double length = distance(&r, upper, t->link[2 * k + 1]);
				assert_near(t->link_length[k], length, 1e-16);
				assert_true(length <= REACH_M);
				farthest = fmax(farthest, length);
				taken++;
			}
		for (int32_t v = 0; v < lower_count; v++) {
			reachable += distance(&r, upper, v) <= REACH_M;
			nearer += distance(&r, upper, v) < farthest * (1 - 1e-12);
		}
		assert_int_equal(taken, reachable < PER_VERTEX ? reachable : PER_VERTEX);
		assert_true(nearer <= taken); // no nearer vertex was skipped
		counted += taken;
	}
	assert_int_equal(counted, t->link_count);
	rig_finish(&r);
}

static void test_out_of_reach_is_refused_by_name(void **state)
{
	(void)state;
	rig r;
	cau_error error = {0};
	begin(&r, 0.9 * GAP_M, 3);
	assert_int_equal(cau_tissue_make(r.scene, &r.arena, &r.tissue, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "layers[2].reach_m");
	assert_non_null(strstr(error.reason, "layer1"));
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_the_nearest_within_reach),
		cmocka_unit_test(test_out_of_reach_is_refused_by_name),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
