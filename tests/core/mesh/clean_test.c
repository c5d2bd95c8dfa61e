// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_text.h"

#include <math.h>

#include "mesh/mesh.h"

// Makes a mesh with copies of these arrays. Its triangles have the regions 10, 11, ..., its
// tetrahedra 20, 21, ...
static cau_mesh copy_of(int32_t vertices, const double *position, int32_t triangles,
                        const int32_t *triangle, int32_t tetrahedra, const int32_t *tetrahedron)
{
	cau_mesh mesh;
	assert_int_equal(cau_mesh_reserve(&mesh, vertices, triangles, tetrahedra, triangles > 0, NULL),
	                 CAU_OK);
	memcpy(mesh.position, position, 3 * (size_t)vertices * sizeof *position);
	for (int32_t i = 0; i < 3 * triangles; i++)
		mesh.triangle[i] = triangle[i];
	for (int32_t i = 0; i < 4 * tetrahedra; i++)
		mesh.tetrahedron[i] = tetrahedron[i];
	for (int32_t i = 0; i < triangles; i++)
		mesh.triangle_region[i] = 10 + i;
	for (int32_t i = 0; i < tetrahedra; i++)
		mesh.tetrahedron_region[i] = 20 + i;
	for (int32_t i = 0; i < 6 * triangles; i++)
		mesh.texture[i] = i * i; // points on a curve, so texture triangles are not flat
	return mesh;
}

static const double square[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

static void a_clean_mesh_stays_as_it_is(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(5, 4, 3);
	cau_mesh mesh, same;
	cau_mesh_report report = {0};
	assert_int_equal(cau_mesh_make_slab(&def, &mesh, NULL), CAU_OK);
	assert_int_equal(cau_mesh_make_slab(&def, &same, NULL), CAU_OK);
	assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
	assert_memory_equal(&report, (&(cau_mesh_report){0}), sizeof report);
	assert_int_equal(mesh.vertex_count, same.vertex_count);
	assert_memory_equal(mesh.position, same.position,
	                    3 * (size_t)same.vertex_count * sizeof(double));
	assert_memory_equal(mesh.tetrahedron, same.tetrahedron,
	                    4 * (size_t)same.tetrahedron_count * sizeof(int32_t));
	cau_mesh_finish(&mesh);
	cau_mesh_finish(&same);
}

// Two triangles of a square without shared vertices. One vertex is 1e-10 away from its partner. Two
// more vertices are unused.
static void unused_and_duplicate_vertices_go(void **state)
{
	(void)state;
	const double position[] = {9, 9, 9, 0, 0, 0, 1, 0, 0, 1,     1, 0,
	                           7, 7, 7, 1, 1, 0, 0, 1, 0, 1e-10, 0, 0};
	cau_mesh mesh = copy_of(8, position, 2, (int32_t[]){1, 2, 3, 7, 5, 6}, 0, NULL);
	cau_mesh_report report = {0};
	assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
	assert_int_equal(report.unused_vertices, 2);
	assert_int_equal(report.duplicate_vertices, 2);
	assert_int_equal(mesh.vertex_count, 4);
	assert_memory_equal(mesh.position, square, sizeof square);
	assert_memory_equal(mesh.triangle, ((int32_t[]){0, 1, 2, 0, 2, 3}), 6 * sizeof(int32_t));
	cau_mesh_finish(&mesh);
}

static void vertices_a_little_farther_stay(void **state)
{
	(void)state;
	const double position[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2e-5, 0, 0};
	cau_mesh mesh = copy_of(5, position, 2, (int32_t[]){0, 1, 2, 4, 2, 3}, 0, NULL);
	cau_mesh_report report = {0};
	assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
	assert_int_equal(report.duplicate_vertices, 0); // the limit is 1e-5 of the diagonal sqrt(2)
	assert_int_equal(mesh.vertex_count, 5);
	cau_mesh_finish(&mesh);
}

// Two near vertices merge at any position within the cells of the hash.
static void vertices_merge_across_cells(void **state)
{
	(void)state;
	for (int i = 0; i < 200; i++) {
		double x = 0.5 + 1e-6 * i;
		const double position[] = {0, 0,        0,        1,        0, 0, x, x,
		                           x, x + 8e-6, x - 8e-6, x + 8e-6, 0, 1, 1};
		cau_mesh mesh = copy_of(5, position, 2, (int32_t[]){0, 1, 2, 3, 4, 0}, 0, NULL);
		cau_mesh_report report = {0};
		assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
		// The two vertices are 1.39e-5 apart; the limit is 1.73e-5.
		assert_int_equal(report.duplicate_vertices, 1);
		cau_mesh_finish(&mesh);
	}
}

static void inverted_tetrahedra_are_turned(void **state)
{
	(void)state;
	const double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
	cau_mesh mesh = copy_of(5, position, 0, NULL, 2, (int32_t[]){0, 2, 1, 3, 1, 2, 3, 4});
	cau_mesh_report report = {0};
	assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
	assert_int_equal(report.inverted_tetrahedra, 1);
	for (int t = 0; t < 2; t++)
		assert_true(fixture_volume6(mesh.position, mesh.tetrahedron + 4 * t) > 0.5);
	assert_int_equal(mesh.tetrahedron_region[0], 20);
	cau_mesh_finish(&mesh);
}

static void repeated_elements_go_with_what_belongs_to_them(void **state)
{
	(void)state;
	const double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
	cau_mesh mesh = copy_of(5, position, 3, (int32_t[]){0, 1, 2, 2, 1, 0, 1, 2, 3}, 3,
	                        (int32_t[]){0, 1, 2, 3, 3, 0, 2, 1, 1, 2, 3, 4});
	cau_mesh_report report = {0};
	assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
	assert_int_equal(report.duplicate_elements, 2);
	assert_int_equal(mesh.triangle_count, 2);
	assert_memory_equal(mesh.triangle, ((int32_t[]){0, 1, 2, 1, 2, 3}), 6 * sizeof(int32_t));
	assert_int_equal(mesh.triangle_region[0], 10);
	assert_int_equal(mesh.triangle_region[1], 12);
	assert_true(mesh.texture[0] == 0 && mesh.texture[6] == 144 && mesh.texture[11] == 289);
	assert_int_equal(mesh.tetrahedron_count, 2);
	assert_int_equal(mesh.tetrahedron_region[1], 22);
	cau_mesh_finish(&mesh);
}

static void refuse(cau_mesh mesh, const char *part)
{
	cau_error error = {0};
	assert_int_equal(cau_mesh_clean(&mesh, NULL, &error), CAU_BAD_MESH);
	if (!strstr(error.reason, part))
		fail_msg("'%s' lacks '%s'", error.reason, part);
	cau_mesh_finish(&mesh);
}

// Cleans the mesh. Expects `left` triangles, and `degenerate` removed ones.
static void leave_out_triangles(cau_mesh mesh, int32_t left, int32_t degenerate)
{
	cau_mesh_report report = {0};
	assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
	assert_int_equal(mesh.triangle_count, left);
	assert_int_equal(report.degenerate_triangles, degenerate);
	for (int32_t i = 0; i < 3 * mesh.triangle_count; i++)
		assert_in_range(mesh.triangle[i], 0, mesh.vertex_count - 1);
	cau_mesh_finish(&mesh);
}

static void degenerate_triangles_are_left_out(void **state)
{
	(void)state;
	double position[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 0, 5e-10, 0};
	int32_t good_then[] = {0, 1, 2, 0, 1, 4};
	leave_out_triangles(copy_of(6, position, 2, good_then, 0, NULL), 1, 1);
	leave_out_triangles(copy_of(6, position, 2, (int32_t[]){0, 1, 2, 0, 5, 2}, 0, NULL), 1, 1);
	position[13] = 3e-6; // a height of 1.5e-6 / 2 relative to the longest edge
	leave_out_triangles(copy_of(6, position, 2, good_then, 0, NULL), 1, 1);
	position[13] = 1e-4; // twenty-five times the least height that is kept
	leave_out_triangles(copy_of(6, position, 2, good_then, 0, NULL), 2, 0);
	refuse(copy_of(6, position, 1, (int32_t[]){2, 1, 1}, 0, NULL), "every element is degenerate");
}

// The measure is relative to the element's size. Thin elements are removed at every size, small
// elements are kept.
static void the_measure_does_not_depend_on_size(void **state)
{
	(void)state;
	for (double size = 1e-8; size < 1e6; size *= 10) {
		double position[] = {0, 0, 0, size, 0, 0, 0, size, 0, 0, 0, size};
		cau_mesh mesh = copy_of(4, position, 1, (int32_t[]){0, 1, 2}, 1, (int32_t[]){0, 1, 2, 3});
		assert_int_equal(cau_mesh_clean(&mesh, NULL, NULL), CAU_OK);
		assert_int_equal(mesh.tetrahedron_count, 1);
		cau_mesh_finish(&mesh);
		memcpy(position + 9, (double[]){size / 3, size / 3, 1e-8 * size}, 3 * sizeof *position);
		refuse(copy_of(4, position, 0, NULL, 1, (int32_t[]){0, 1, 2, 3}),
		       "every element is degenerate: 0 flat triangles, 1 flat tetrahedra");
	}
}

static void degenerate_tetrahedra_are_left_out(void **state)
{
	(void)state;
	const double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0};
	cau_mesh mesh =
		copy_of(5, position, 0, NULL, 3, (int32_t[]){0, 1, 2, 4, 0, 1, 2, 3, 0, 1, 2, 0});
	cau_mesh_report report = {0};
	assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
	assert_int_equal(report.degenerate_tetrahedra, 2);
	assert_int_equal(report.unused_vertices, 1); // only removed elements had this vertex
	assert_int_equal(mesh.tetrahedron_count, 1);
	assert_int_equal(mesh.tetrahedron_region[0], 21);
	assert_int_equal(mesh.vertex_count, 4);
	cau_mesh_finish(&mesh);
}

// A flat texture triangle becomes zeros, which give no direction. The triangle itself stays.
static void degenerate_texture_triangles_are_left_out(void **state)
{
	(void)state;
	const double position[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	const double uv[12] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 2, 0}, zeros[6] = {0};
	for (int k = 0; k < 2; k++) {
		cau_mesh mesh = copy_of(4, position, 2, (int32_t[]){0, 1, 2, 0, 2, 3}, 0, NULL);
		cau_mesh_report report = {0};
		memcpy(mesh.texture, uv, sizeof uv);
		mesh.texture[9] = k ? NAN : 0;
		assert_int_equal(cau_mesh_clean(&mesh, &report, NULL), CAU_OK);
		assert_int_equal(report.degenerate_textures, 1);
		assert_int_equal(mesh.triangle_count, 2);
		assert_memory_equal(mesh.texture, uv, 6 * sizeof *uv);
		assert_memory_equal(mesh.texture + 6, zeros, sizeof zeros);
		cau_mesh_finish(&mesh);
	}
}

static void impossible_numbers_are_refused(void **state)
{
	(void)state;
	const int32_t triangle[] = {0, 1, 2};
	double position[] = {0, 0, 0, 1, 0, 0, 1, 1, 0};
	refuse((cau_mesh){0}, "no triangles and no tetrahedra");
	refuse(copy_of(3, position, 1, (int32_t[]){0, 1, 3}, 0, NULL), "triangle 0 names vertex 3");
	refuse(copy_of(3, position, 0, NULL, 1, (int32_t[]){0, 1, 2, -1}),
	       "tetrahedron 0 names vertex");
	position[4] = INFINITY;
	refuse(copy_of(3, position, 1, triangle, 0, NULL), "vertex 1: its y is not finite");
	position[4] = 1e300;
	refuse(copy_of(3, position, 1, triangle, 0, NULL), "check unit_m");
	position[4] = 2e6;
	refuse(copy_of(3, position, 1, triangle, 0, NULL), "check unit_m");
	const double far[] = {3e6, 0, 0, 3e6 + 1, 0, 0, 3e6, 1, 0};
	refuse(copy_of(3, far, 1, triangle, 0, NULL), "3e+06 m from the origin");
	const double tiny[] = {0, 0, 0, 1e-10, 0, 0, 0, 1e-10, 0};
	refuse(copy_of(3, tiny, 1, triangle, 0, NULL), "check unit_m");
	// the second triangle is removed, and the first alone is too small
	const double long_[] = {0, 0, 0, 5e-10, 0, 0, 0, 5e-10, 0, 4e-5, 0, 0, 2e-5, 0, 0};
	refuse(copy_of(5, long_, 2, (int32_t[]){0, 1, 2, 0, 3, 4}, 0, NULL), "check unit_m");
	const double point[] = {1, 2, 3, 1, 2, 3, 1, 2, 3};
	refuse(copy_of(3, point, 1, triangle, 0, NULL), "all vertices lie on one point");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_clean_mesh_stays_as_it_is),
		cmocka_unit_test(unused_and_duplicate_vertices_go),
		cmocka_unit_test(vertices_a_little_farther_stay),
		cmocka_unit_test(vertices_merge_across_cells),
		cmocka_unit_test(inverted_tetrahedra_are_turned),
		cmocka_unit_test(repeated_elements_go_with_what_belongs_to_them),
		cmocka_unit_test(degenerate_triangles_are_left_out),
		cmocka_unit_test(the_measure_does_not_depend_on_size),
		cmocka_unit_test(degenerate_tetrahedra_are_left_out),
		cmocka_unit_test(degenerate_texture_triangles_are_left_out),
		cmocka_unit_test(impossible_numbers_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
