// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_fixture.h"

#include <math.h>

// Largest relative error of a sum: rounding of 30,000 terms.
static const double sum_tolerance = 1e-12;

static void sheet_of_the_fascia_scene_has_its_counts(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(60, 50, 1);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_sheet(&def, &mesh, NULL), CAU_OK);
	assert_int_equal(mesh.vertex_count, 3111);
	assert_int_equal(mesh.triangle_count, 6000);
	assert_int_equal(mesh.tetrahedron_count, 0);

	double area = 0;
	for (int t = 0; t < mesh.triangle_count; t++) {
		double normal[3];
		fixture_normal(mesh.position, mesh.triangle + 3 * t, normal);
		assert_true(normal[2] > 0 && normal[0] == 0 && normal[1] == 0);
		area += 0.5 * normal[2];
	}
	assert_true(fabs(area / (0.12 * 0.10) - 1) < sum_tolerance);
	cau_mesh_finish(&mesh);
}

static void sheet_is_centred_with_its_corners_at_half_the_size(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(3, 4, 1);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_sheet(&def, &mesh, NULL), CAU_OK);
	const double *last = mesh.position + 3 * (mesh.vertex_count - 1);
	assert_true(mesh.position[0] == -0.06 && mesh.position[1] == -0.05 && mesh.position[2] == 0);
	assert_true(last[0] == 0.06 && last[1] == 0.05 && last[2] == 0);
	cau_mesh_finish(&mesh);
}

static void texture_turns_against_the_mesh(void **state)
{
	(void)state;
	const double turns[] = {0, 0.5, -2};
	for (int i = 0; i < 3; i++) {
		cau_mesh_def def = fixture_def(2, 2, 1);
		def.texture_turn_rad = turns[i];
		cau_mesh mesh;
		assert_int_equal(cau_mesh_make_sheet(&def, &mesh, NULL), CAU_OK);
		// A point one unit along the turned u axis has UV (1, 0), so u = x . (cos, sin).
		for (int corner = 0; corner < 3 * mesh.triangle_count; corner++) {
			const double *x = mesh.position + 3 * mesh.triangle[corner];
			double u = x[0] * cos(turns[i]) + x[1] * sin(turns[i]);
			double v = x[1] * cos(turns[i]) - x[0] * sin(turns[i]);
			assert_true(fabs(mesh.texture[2 * corner] - u) < sum_tolerance);
			assert_true(fabs(mesh.texture[2 * corner + 1] - v) < sum_tolerance);
		}
		cau_mesh_finish(&mesh);
	}
}

static void slab_of_the_fat_scene_has_its_counts(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(50, 25, 4);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_slab(&def, &mesh, NULL), CAU_OK);
	assert_int_equal(mesh.vertex_count, 6630);
	assert_int_equal(mesh.tetrahedron_count, 30000);
	assert_int_equal(mesh.triangle_count, 0);

	double volume = 0, cell = 0.12 * 0.10 * 0.008 / (50 * 25 * 4);
	for (int t = 0; t < mesh.tetrahedron_count; t++) {
		double volume6 = fixture_volume6(mesh.position, mesh.tetrahedron + 4 * t);
		assert_true(fabs(volume6 / cell - 1) < 1e-9); // all six have the same positive volume
		volume += volume6 / 6;
	}
	assert_true(fabs(volume / (0.12 * 0.10 * 0.008) - 1) < sum_tolerance);

	cau_primitives primitives = fixture_primitives(&mesh);
	cau_face_table faces;
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	int boundary = 0;
	for (int f = 0; f < faces.face_count; f++)
		boundary += faces.owner[2 * f + 1] < 0;
	assert_int_equal(boundary, 6200); // the mesh is conforming: no inner face has only one owner
	cau_face_table_finish(&faces);
	cau_mesh_finish(&mesh);
}

static void slab_lies_below_zero(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(2, 3, 4);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_slab(&def, &mesh, NULL), CAU_OK);
	double least = 1, most = -1;
	for (int v = 0; v < mesh.vertex_count; v++) {
		least = fmin(least, mesh.position[3 * v + 2]);
		most = fmax(most, mesh.position[3 * v + 2]);
	}
	assert_true(least == -0.008 && most == 0);
	cau_mesh_finish(&mesh);
}

static void pattern_is_a_closed_fan(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(7, 1, 1);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_pattern(&def, &mesh, NULL), CAU_OK);
	assert_int_equal(mesh.vertex_count, 8);
	assert_int_equal(mesh.triangle_count, 7);
	cau_primitives primitives = fixture_primitives(&mesh);
	int32_t layer[7] = {0};
	cau_edge_table edges;
	assert_int_equal(cau_edge_table_make(&primitives, layer, &edges, NULL), CAU_OK);
	assert_int_equal(edges.edge_count, 14);
	assert_int_equal(edges.hinge_count, 7);
	cau_edge_table_finish(&edges);
	cau_mesh_finish(&mesh);
}

static void refuse(cau_status (*make)(const cau_mesh_def *, cau_mesh *, cau_error *),
                   cau_mesh_def def, cau_status expected, const char *path)
{
	cau_mesh mesh;
	cau_error error = {0};
	assert_int_equal(make(&def, &mesh, &error), expected);
	assert_int_equal(error.status, expected);
	assert_string_equal(error.path, path);
	assert_true(error.reason[0]);
	assert_null(mesh.position);
}

static void absurd_definitions_are_refused(void **state)
{
	(void)state;
	refuse(cau_mesh_make_sheet, fixture_def(0, 5, 1), CAU_BAD_VALUE, "cells");
	refuse(cau_mesh_make_sheet, fixture_def(5, -1, 1), CAU_BAD_VALUE, "cells");
	refuse(cau_mesh_make_sheet, fixture_def(INT32_MAX, INT32_MAX, 1), CAU_LIMIT, "cells");
	refuse(cau_mesh_make_slab, fixture_def(2000, 2000, 2000), CAU_LIMIT, "cells");
	refuse(cau_mesh_make_slab, fixture_def(INT32_MAX, INT32_MAX, INT32_MAX), CAU_LIMIT, "cells");
	refuse(cau_mesh_make_pattern, fixture_def(2, 1, 1), CAU_BAD_VALUE, "cells");
	refuse(cau_mesh_make_pattern, fixture_def(1001, 1, 1), CAU_BAD_VALUE, "cells");
	cau_mesh_def def = fixture_def(2, 2, 2);
	def.size_m[1] = 0;
	refuse(cau_mesh_make_sheet, def, CAU_BAD_VALUE, "size_m");
	def.size_m[1] = NAN;
	refuse(cau_mesh_make_slab, def, CAU_BAD_VALUE, "size_m");
	def.size_m[1] = 0.1;
	def.texture_turn_rad = INFINITY;
	refuse(cau_mesh_make_sheet, def, CAU_BAD_VALUE, "texture_turn_rad");
	refuse(cau_mesh_make_pattern, (def.cells[0] = 5, def), CAU_BAD_VALUE, "texture_turn_rad");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sheet_of_the_fascia_scene_has_its_counts),
		cmocka_unit_test(sheet_is_centred_with_its_corners_at_half_the_size),
		cmocka_unit_test(texture_turns_against_the_mesh),
		cmocka_unit_test(slab_of_the_fat_scene_has_its_counts),
		cmocka_unit_test(slab_lies_below_zero),
		cmocka_unit_test(pattern_is_a_closed_fan),
		cmocka_unit_test(absurd_definitions_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
