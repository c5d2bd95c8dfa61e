// SPDX-License-Identifier: GPL-3.0-or-later
// The boxes of the broad phase find all that a search over all elements finds, however the tissue
// has moved.
#include <string.h>

#include "core/dissect/cutting.h"

// Returns the distance of a point from a segment.
static double segment_distance(cau_vec3 p, cau_vec3 a, cau_vec3 b)
{
	cau_vec3 along = cau_sub(b, a);
	double length2 = cau_dot(along, along);
	double t = length2 > 0 ? fmin(fmax(cau_dot(cau_sub(p, a), along) / length2, 0), 1) : 0;
	return cau_length(cau_sub(p, cau_add_scaled(a, t, along)));
}

static void test_blocks_hold_everything_once(void **state)
{
	(void)state;
	rig r;
	cau_near near = {0};
	rig_begin(&r);
	add_all_layers(&r);
	rig_build(&r, NULL, 1);
	assert_int_equal(cau_near_create(&near, &r.tissue, &r.arena, NULL), CAU_OK);
	uint8_t *seen = cau_arena_array(&r.arena, (size_t)r.tissue.edges.edge_count, 1);
	for (int32_t i = 0; i < r.tissue.vertex_count; i++) {
		assert_false(seen[near.vertex[i]]);
		seen[near.vertex[i]] = 1;
	}
	memset(seen, 0, (size_t)r.tissue.edges.edge_count);
	assert_int_equal(near.edge_first[0], 0);
	assert_int_equal(near.edge_first[near.block_count], r.tissue.edges.edge_count);
	for (int32_t k = 0; k < r.tissue.edges.edge_count; k++) {
		assert_false(seen[near.edge[k]]);
		seen[near.edge[k]] = 1;
	}
	int32_t faces = r.tissue.faces.face_count;
	uint8_t *seen_face = cau_arena_array(&r.arena, (size_t)faces, 1);
	assert_int_equal(near.face_first[0], 0);
	assert_int_equal(near.face_first[near.block_count], faces);
	for (int32_t k = 0; k < faces; k++) {
		assert_false(seen_face[near.face[k]]);
		seen_face[near.face[k]] = 1;
	}
	rig_finish(&r);
}

static void test_boxes_find_what_brute_force_finds(void **state)
{
	(void)state;
	rig r;
	cau_near near = {0};
	rig_begin(&r);
	add_all_layers(&r);
	rig_build(&r, NULL, 1);
	assert_int_equal(cau_near_create(&near, &r.tissue, &r.arena, NULL), CAU_OK);
	uint64_t random = 151;
	double a[3][3];
	int32_t found = 0, left_out = 0;
	for (int pose = 0; pose < 6; pose++) {
		rig_random_gradient(&random, pose ? 1 : 0, a);
		rig_deform(&r, a, pose ? 0.02 : 0, &random, r.solver.position);
		const double *x = r.solver.position;
		cau_near_refit(&near, x);
		for (int probe = 0; probe < 60; probe++) {
			cau_vec3 center = random_point(&random, 0.08);
			double radius = random_between(&random, 0.001, 0.03);
			for (int32_t b = 0; b < near.block_count; b++) {
				int meets_edges = cau_box_meets(&near.edge_box[b], center, radius);
				int meets_vertices = cau_box_meets(&near.vertex_box[b], center, radius);
				left_out += !meets_edges;
				for (int32_t k = near.edge_first[b]; k < near.edge_first[b + 1]; k++) {
					const int32_t *v = r.tissue.edges.vertex + 2 * near.edge[k];
					if (segment_distance(center, cau_vec3_of(x + 3 * v[0]),
					                     cau_vec3_of(x + 3 * v[1])) <= radius) {
						assert_true(meets_edges);
						found++;
					}
				}
				for (int32_t k = near.face_first[b]; k < near.face_first[b + 1]; k++)
					for (int c = 0; c < 3; c++) {
						int32_t v = r.tissue.faces.vertex[3 * near.face[k] + c];
						if (cau_length(cau_sub(cau_vec3_of(x + 3 * v), center)) <= radius)
							assert_true(meets_edges);
					}
				for (int32_t i = b * CAU_NEAR_BLOCK;
				     i < (b + 1) * CAU_NEAR_BLOCK && i < near.vertex_count; i++)
					if (cau_length(cau_sub(cau_vec3_of(x + 3 * near.vertex[i]), center)) <= radius)
						assert_true(meets_vertices);
			}
		}
	}
	assert_true(found > 100 && left_out > 1000); // some are found, and some are left out
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_blocks_hold_everything_once),
		cmocka_unit_test(test_boxes_find_what_brute_force_finds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
