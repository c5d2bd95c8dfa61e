// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that cells that share a quadrangle divide it in the same way, whichever corner each cell
// lists first. Polygons are cut without folds.
#include "mesh_fixture.h"

#include <math.h>

#include "mesh/geometry.h"
#include "mesh/mesh_builder.h"

enum { SIDE = 4, POINTS = SIDE * SIDE * SIDE };

// Turns a hexahedron in one of 24 ways, or mirrors it too (48 ways in all).
static void turn(int32_t vertex[8], unsigned way)
{
	static const int quarter[8] = {1, 2, 3, 0, 5, 6, 7, 4}, roll[8] = {3, 2, 6, 7, 0, 1, 5, 4};
	static const int mirror[8] = {4, 5, 6, 7, 0, 1, 2, 3};
	for (unsigned step = 0; step < 10; step++) {
		const int *map = step < way % 4              ? quarter
		                 : step < 4                  ? NULL
		                 : step < 4 + way / 4 % 4    ? roll
		                 : step == 9 && way % 3 == 0 ? mirror
		                                             : NULL;
		int32_t old[8];
		memcpy(old, vertex, sizeof old);
		for (int i = 0; map && i < 8; i++)
			vertex[i] = old[map[i]];
	}
}

// Makes a block of 3 x 3 x 3 cells. `seed` mixes the order of its vertices. If `wedges`, every
// second column is made of wedges.
static void make_block(cau_mesh_builder *builder, unsigned seed, bool wedges)
{
	int32_t number[POINTS];
	double position[POINTS][3];
	for (int i = 0; i < POINTS; i++)
		number[i] = i;
	for (int i = POINTS - 1; i > 0; i--) {
		seed = seed * 1664525u + 1013904223u;
		int j = (int)((seed >> 8) % (unsigned)(i + 1)), kept = number[i];
		number[i] = number[j];
		number[j] = kept;
	}
	for (int i = 0; i < POINTS; i++)
		for (int c = 0; c < 3; c++)
			position[number[i]][c] = i / (c == 0 ? 1 : c == 1 ? SIDE : SIDE * SIDE) % SIDE;
	for (int i = 0; i < POINTS; i++)
		cau_mesh_builder_vertex(builder, position[i]);
	for (int cell = 0; cell < 27; cell++) {
		int at = cell % 3 + cell / 3 % 3 * SIDE + cell / 9 * SIDE * SIDE;
		int32_t v[8];
		const int step[8] = {0, 1, 1 + SIDE, SIDE, 16, 17, 17 + SIDE, 16 + SIDE};
		for (int i = 0; i < 8; i++)
			v[i] = number[at + step[i]];
		// Wedges fill whole columns, because their triangles do not match the faces of hexahedra.
		bool column = wedges && (cell % 3 + cell / 3 % 3) % 2;
		seed = seed * 1664525u + 1013904223u;
		if (!column) {
			turn(v, seed >> 8);
			cau_mesh_builder_cell(builder, CAU_SHAPE_HEXAHEDRON, v, cell, "hexahedra", false);
			continue;
		}
		cau_mesh_builder_cell(builder, CAU_SHAPE_WEDGE,
		                      (int32_t[]){v[0], v[1], v[2], v[4], v[5], v[6]}, cell, "wedges",
		                      false);
		cau_mesh_builder_cell(builder, CAU_SHAPE_WEDGE,
		                      (int32_t[]){v[0], v[2], v[3], v[4], v[6], v[7]}, cell, "wedges",
		                      false);
	}
}

static void cells_side_by_side_fit(void **state)
{
	(void)state;
	for (unsigned seed = 1; seed <= 200; seed++) {
		cau_error error = {0};
		cau_scan scan = cau_scan_make("", 0, &error);
		cau_mesh_builder builder = {.scan = &scan};
		make_block(&builder, seed, seed % 2);
		cau_cell_split(&builder);
		assert_int_equal(scan.status, CAU_OK);
		assert_int_equal(builder.mesh.tetrahedron_count, 27 * 6);
		double volume = 0;
		for (int32_t t = 0; t < builder.mesh.tetrahedron_count; t++) {
			double own = fixture_volume6(builder.mesh.position, builder.mesh.tetrahedron + 4 * t);
			assert_true(own > 0.5);
			volume += own / 6;
		}
		assert_true(fabs(volume - 27) < 1e-9);
		cau_primitives primitives = fixture_primitives(&builder.mesh);
		cau_face_table faces;
		int32_t outside = 0;
		assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
		for (int32_t f = 0; f < faces.face_count; f++)
			outside += faces.owner[2 * f + 1] < 0;
		assert_int_equal(outside, 6 * 9 * 2); // cells that do not match leave faces inside
		cau_face_table_finish(&faces);
		cau_mesh_builder_finish(&builder);
	}
}

// The polygon is a comb with teeth. A fan around its first corner would fold.
static void a_polygon_that_is_not_convex_has_no_folds(void **state)
{
	(void)state;
	enum { TEETH = 9, CORNERS = 2 * TEETH + 2 };
	double position[CORNERS][3] = {{0}};
	int32_t vertex[CORNERS], cut[CORNERS - 2][3];
	for (int i = 0; i < CORNERS; i++)
		vertex[i] = i;
	for (int i = 0; i < 2 * TEETH; i++) {
		position[i][0] = 2 * TEETH - i;
		position[i][1] = i % 2 ? 1 : 3;
	}
	memcpy(position[2 * TEETH], (double[]){0, 0, 0}, sizeof position[0]);
	memcpy(position[2 * TEETH + 1], (double[]){2 * TEETH, 0, 0}, sizeof position[0]);
	double whole = 0, sum = 0;
	for (int i = 0; i < CORNERS; i++) {
		const double *a = position[i], *b = position[(i + 1) % CORNERS];
		whole += 0.5 * (a[0] * b[1] - a[1] * b[0]);
	}
	assert_true(cau_polygon_cut(position[0], vertex, CORNERS, cut));
	for (int i = 0; i < CORNERS - 2; i++) {
		double normal[3];
		cau_triangle_normal(position[0], cut[i], normal);
		assert_true(normal[2] > 0);
		sum += 0.5 * normal[2];
	}
	assert_true(fabs(sum - whole) < 1e-12);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cells_side_by_side_fit),
		cmocka_unit_test(a_polygon_that_is_not_convex_has_no_folds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
