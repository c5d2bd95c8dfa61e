// SPDX-License-Identifier: GPL-3.0-or-later
// Layers with one common vertex array: shared vertices, material directions, and refused scenes.
#include <stdlib.h>
#include <string.h>

#include "core/dissect/cutting.h"

static const double FRAME_TOLERANCE = 1e-13; // largest error of a unit vector: a few roundings

static void test_layers_lie_one_after_the_other(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	add_all_layers(&r);
	rig_build(&r, NULL, 1);
	const cau_tissue_layer *fat = &r.tissue.layer[0], *membrane = fat + 1, *fascia = fat + 2;
	assert_int_equal(fat->tetrahedron_count, 6 * 6 * 5 * 3);
	assert_int_equal(membrane->triangle_count, 4 * (6 * 5 + 5 * 3 + 3 * 6));
	assert_int_equal(fascia->triangle_count, 2 * 7 * 6);
	// A membrane has the vertices of its fat.
	assert_int_equal(membrane->first_vertex, fat->first_vertex);
	assert_int_equal(membrane->vertex_count, fat->vertex_count);
	assert_int_equal(fascia->first_vertex, fat->vertex_count);
	assert_int_equal(r.tissue.vertex_count, 7 * 6 * 4 + 8 * 7);
	for (int32_t t = 0; t < r.tissue.triangle_count; t++) {
		const cau_tissue_layer *layer = &r.tissue.layer[r.tissue.triangle_layer[t]];
		assert_true(t >= layer->first_triangle &&
		            t < layer->first_triangle + layer->triangle_count);
		for (int i = 0; i < 3; i++) {
			int32_t v = r.tissue.triangle[3 * t + i] - layer->first_vertex;
			assert_in_range(v, 0, layer->vertex_count - 1);
		}
	}
	assert_int_equal(cau_tissue_find_layer(&r.tissue, "layer2"), 2);
	assert_int_equal(cau_tissue_find_layer(&r.tissue, "skin"), -1);
	rig_finish(&r);
}

static void test_membrane_is_the_outward_boundary(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	add_all_layers(&r);
	rig_build(&r, NULL, 1);
	const cau_tissue_layer *membrane = &r.tissue.layer[1];
	double flux = 0; // flux of x through the surface: three times the volume
	for (int32_t t = membrane->first_triangle;
	     t < membrane->first_triangle + membrane->triangle_count; t++) {
		const int32_t *v = r.tissue.triangle + 3 * t;
		cau_vec3 a = cau_vec3_of(r.tissue.rest + 3 * v[0]);
		cau_vec3 b = cau_vec3_of(r.tissue.rest + 3 * v[1]);
		flux += cau_dot(a, cau_cross(b, cau_vec3_of(r.tissue.rest + 3 * v[2]))) / 2;
	}
	assert_near(flux, 3 * 0.1 * 0.08 * 0.03, 1e-15); // rounding of 7.2e-4 in double, with a margin
	rig_finish(&r);
}

static void assert_frame(const rig *r, int32_t triangle)
{
	const double *u = r->tissue.triangle_frame + 6 * triangle, *v = u + 3;
	const int32_t *vertex = r->tissue.triangle + 3 * triangle;
	cau_vec3 a = cau_vec3_of(r->tissue.rest + 3 * vertex[0]);
	cau_vec3 normal = cau_cross(cau_sub(cau_vec3_of(r->tissue.rest + 3 * vertex[1]), a),
	                            cau_sub(cau_vec3_of(r->tissue.rest + 3 * vertex[2]), a));
	normal = cau_unit_or(normal, (cau_vec3){0, 0, 0});
	cau_vec3 tu = cau_vec3_of(u), tv = cau_vec3_of(v);
	assert_near(cau_dot(tu, tu), 1, FRAME_TOLERANCE);
	assert_near(cau_dot(tv, tv), 1, FRAME_TOLERANCE);
	assert_near(cau_dot(tu, tv), 0, FRAME_TOLERANCE);
	assert_near(cau_dot(tu, normal), 0, FRAME_TOLERANCE);
	assert_near(cau_dot(tv, normal), 0, FRAME_TOLERANCE);
}

static void test_frames_are_orthonormal(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	add_all_layers(&r);
	r.scene->meshes[1].texture_turn_rad = 0.7;
	memcpy(r.scene->layers[1].fibre, (double[]){0.2, -0.9, 0.1}, 3 * sizeof(double));
	rig_build(&r, NULL, 1);
	for (int32_t t = 0; t < r.tissue.triangle_count; t++)
		assert_frame(&r, t);
	rig_finish(&r);
}

// t_u points where the texture coordinate u grows: rotated against x and y by the texture's
// rotation.
static void test_texture_gives_the_direction(void **state)
{
	(void)state;
	const double turn = 0.7;
	rig r;
	rig_begin(&r);
	rig_add_sheet(&r, 3, 2);
	r.scene->meshes[0].texture_turn_rad = turn;
	rig_build(&r, NULL, 1);
	for (int32_t t = 0; t < r.tissue.triangle_count; t++) {
		const double expected[6] = {cos(turn), sin(turn), 0, -sin(turn), cos(turn), 0};
		for (int i = 0; i < 6; i++)
			assert_near(r.tissue.triangle_frame[6 * t + i], expected[i], FRAME_TOLERANCE);
	}
	rig_finish(&r);
}

// Without a texture the fibre is projected into the plane. If the fibre is normal to the plane,
// some axis in the plane is taken.
static void test_fibre_gives_the_direction(void **state)
{
	(void)state;
	static const double points[3][3] = {{0, 0, 0}, {0.02, 0, 0}, {0, 0.02, 0}};
	static const int32_t vertex[3] = {0, 1, 2};
	static const double fibres[2][3] = {{0.6, 0.8, 5}, {0, 0, 2}};
	for (int k = 0; k < 2; k++) {
		rig r;
		rig_begin(&r);
		cau_layer_def *layer = rig_add_triangles(&r, 3, points[0], 1, vertex);
		memcpy(layer->fibre, fibres[k], sizeof fibres[k]);
		rig_build(&r, NULL, 1);
		assert_frame(&r, 0);
		if (!k) {
			assert_near(r.tissue.triangle_frame[0], 0.6, FRAME_TOLERANCE);
			assert_near(r.tissue.triangle_frame[1], 0.8, FRAME_TOLERANCE);
		}
		rig_finish(&r);
	}
}

// A texture on one line gives no direction, so the fibre is used. A flat triangle is left out.
static void test_degenerate_triangles_are_left_out(void **state)
{
	(void)state;
	static const char text[] =
		"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 0 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
		"vt 2 0\nf 1/1 2/2 3/3\nf 2/2 4/4 3/1\nf 1/1 2/2 5/3\n";
	rig r;
	cau_error error = {0};
	rig_begin(&r);
	rig_add_triangles(&r, 0, NULL, 0, NULL);
	r.scene->layers[0].fibre[0] = 0.6;
	r.scene->layers[0].fibre[1] = 0.8;
	r.scene->meshes[0].bytes = text;
	r.scene->meshes[0].byte_count = sizeof text - 1;
	assert_int_equal(cau_tissue_make(r.scene, &r.arena, &r.tissue, &error), CAU_OK);
	assert_int_equal(r.tissue.triangle_count, 2);
	assert_int_equal(r.tissue.mesh_report[0].degenerate_triangles, 1);
	assert_int_equal(r.tissue.mesh_report[0].degenerate_textures, 1);
	assert_frame(&r, 0);
	assert_frame(&r, 1);
	assert_near(r.tissue.triangle_frame[0], 1, FRAME_TOLERANCE);
	assert_near(r.tissue.triangle_frame[6], 0.6, FRAME_TOLERANCE);
	assert_near(r.tissue.triangle_frame[7], 0.8, FRAME_TOLERANCE);
	rig_finish(&r);
}

static void test_layers_without_elements_are_refused_by_name(void **state)
{
	(void)state;
	for (int kind = 0; kind < 2; kind++) {
		rig r;
		cau_error error = {0};
		rig_begin(&r);
		if (kind)
			rig_add_slab(&r, 1, 1, 1)->kind = CAU_LAYER_FASCIA;
		else
			rig_add_sheet(&r, 1, 1)->kind = CAU_LAYER_FAT;
		assert_int_equal(cau_tissue_make(r.scene, &r.arena, &r.tissue, &error), CAU_BAD_MESH);
		assert_string_equal(error.path, "layers[0].mesh");
		assert_non_null(strstr(error.reason, "mesh0"));
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_layers_lie_one_after_the_other),
		cmocka_unit_test(test_membrane_is_the_outward_boundary),
		cmocka_unit_test(test_frames_are_orthonormal),
		cmocka_unit_test(test_texture_gives_the_direction),
		cmocka_unit_test(test_fibre_gives_the_direction),
		cmocka_unit_test(test_degenerate_triangles_are_left_out),
		cmocka_unit_test(test_layers_without_elements_are_refused_by_name),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
