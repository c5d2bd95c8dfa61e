// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_fixture.h"

static void check_outward(const cau_mesh *mesh, const cau_face_table *faces)
{
	for (int32_t f = faces->triangle_count; f < faces->face_count; f++) {
		const int32_t *face = faces->vertex + 3 * f;
		const int32_t *owner = mesh->tetrahedron + 4 * faces->owner[2 * f];
		double normal[3], toward = 0;
		fixture_normal(mesh->position, face, normal);
		for (int c = 0; c < 3; c++) {
			double centre = 0;
			for (int i = 0; i < 4; i++)
				centre += 0.25 * mesh->position[3 * owner[i] + c];
			toward += normal[c] * (centre - mesh->position[3 * face[0] + c]);
		}
		assert_true(toward < 0);
	}
}

// Checks that face k of a tetrahedron has the other three vertices and has the tetrahedron as an
// owner.
static void check_owners(const cau_primitives *p, const cau_face_table *faces)
{
	int32_t uses = 0;
	for (int32_t t = 0; t < p->tetrahedron_count; t++)
		for (int k = 0; k < 4; k++) {
			int32_t f = faces->tetrahedron_face[4 * t + k];
			assert_in_range(f, faces->triangle_count, faces->face_count - 1);
			assert_true(faces->owner[2 * f] == t || faces->owner[2 * f + 1] == t);
			for (int c = 0; c < 4; c++) {
				int found = 0;
				for (int i = 0; i < 3; i++)
					found += faces->vertex[3 * f + i] == p->tetrahedron[4 * t + c];
				assert_int_equal(found, c != k);
			}
		}
	for (int32_t f = faces->triangle_count; f < faces->face_count; f++) {
		assert_true(faces->owner[2 * f] >= 0);
		assert_true(faces->owner[2 * f + 1] == -1 || faces->owner[2 * f] < faces->owner[2 * f + 1]);
		uses += 1 + (faces->owner[2 * f + 1] >= 0);
	}
	assert_int_equal(uses, 4 * p->tetrahedron_count);
}

static void one_tetrahedron_has_four_faces(void **state)
{
	(void)state;
	double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
	int32_t tetrahedron[] = {0, 1, 2, 3};
	cau_mesh mesh = {.vertex_count = 4,
	                 .tetrahedron_count = 1,
	                 .position = position,
	                 .tetrahedron = tetrahedron};
	cau_primitives primitives = fixture_primitives(&mesh);
	cau_face_table faces;
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	assert_int_equal(faces.face_count, 4);
	check_outward(&mesh, &faces);
	check_owners(&primitives, &faces);
	cau_face_table_finish(&faces);
}

static void two_tetrahedra_share_one_face(void **state)
{
	(void)state;
	double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
	int32_t tetrahedron[] = {1, 2, 3, 4, 0, 1, 2, 3};
	cau_mesh mesh = {.vertex_count = 5,
	                 .tetrahedron_count = 2,
	                 .position = position,
	                 .tetrahedron = tetrahedron};
	assert_true(fixture_volume6(position, tetrahedron) > 0);
	cau_primitives primitives = fixture_primitives(&mesh);
	cau_face_table faces;
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	assert_int_equal(faces.face_count, 7);
	assert_int_equal(faces.tetrahedron_face[3], faces.tetrahedron_face[4]);
	check_outward(&mesh, &faces);
	check_owners(&primitives, &faces);
	cau_face_table_finish(&faces);
}

static void triangles_cover_faces_with_their_vertices(void **state)
{
	(void)state;
	const int32_t tetrahedron[] = {0, 1, 2, 3};
	const int32_t triangle[] = {0, 4, 1, 3, 1, 2, 1, 2, 3, 2, 1, 0};
	cau_primitives primitives = {.vertex_count = 5,
	                             .triangle_count = 4,
	                             .triangle = triangle,
	                             .tetrahedron_count = 1,
	                             .tetrahedron = tetrahedron};
	cau_face_table faces;
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	assert_int_equal(faces.triangle_count, 4);
	assert_int_equal(faces.face_count, 8);
	assert_memory_equal(faces.vertex, triangle, sizeof triangle);
	for (int t = 0; t < 4; t++) {
		assert_int_equal(faces.cover[t], -1);
		assert_int_equal(faces.owner[2 * t], -1);
		assert_int_equal(faces.owner[2 * t + 1], -1);
	}
	int32_t opposite_0 = faces.tetrahedron_face[0], opposite_3 = faces.tetrahedron_face[3];
	assert_int_equal(faces.triangle_covers[0], -1);
	assert_int_equal(faces.triangle_covers[1], opposite_0);
	assert_int_equal(faces.triangle_covers[2], opposite_0); // two sheets cover one face
	assert_int_equal(faces.cover[opposite_0], 1); // the triangle of lower index is the cover
	assert_int_equal(faces.triangle_covers[3], opposite_3);
	assert_int_equal(faces.cover[opposite_3], 3);
	assert_int_equal(faces.cover[faces.tetrahedron_face[1]], -1);
	check_owners(&primitives, &faces);
	cau_face_table_finish(&faces);
}

static void slab_faces_point_outward(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(5, 4, 3);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_slab(&def, &mesh, NULL), CAU_OK);
	cau_primitives primitives = fixture_primitives(&mesh);
	cau_face_table faces;
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	check_outward(&mesh, &faces);
	check_owners(&primitives, &faces);
	cau_face_table_finish(&faces);
	cau_mesh_finish(&mesh);
}

static void a_face_of_three_tetrahedra_is_refused_by_name(void **state)
{
	(void)state;
	const int32_t tetrahedron[] = {3, 4, 5, 6, 0, 1, 2, 3, 0, 1, 2, 4, 0, 2, 1, 5};
	cau_primitives primitives = {
		.vertex_count = 7, .tetrahedron_count = 4, .tetrahedron = tetrahedron};
	cau_face_table faces;
	cau_error error = {0};
	assert_int_equal(cau_face_table_make(&primitives, &faces, &error), CAU_BAD_MESH);
	assert_non_null(strstr(error.reason, "tetrahedra 1, 2 and 3 share one face"));
	assert_null(faces.vertex);
}

static void bad_indices_are_refused(void **state)
{
	(void)state;
	const int32_t tetrahedron[] = {0, 1, 2, 7};
	cau_primitives primitives = {
		.vertex_count = 7, .tetrahedron_count = 1, .tetrahedron = tetrahedron};
	cau_face_table faces;
	cau_error error = {0};
	assert_int_equal(cau_face_table_make(&primitives, &faces, &error), CAU_BAD_MESH);
	assert_non_null(strstr(error.reason, "tetrahedron 0 names vertex 7"));
}

static void nothing_makes_an_empty_table(void **state)
{
	(void)state;
	cau_primitives primitives = {0};
	cau_face_table faces;
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	assert_int_equal(faces.face_count, 0);
	cau_face_table_finish(&faces);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_tetrahedron_has_four_faces),
		cmocka_unit_test(two_tetrahedra_share_one_face),
		cmocka_unit_test(triangles_cover_faces_with_their_vertices),
		cmocka_unit_test(slab_faces_point_outward),
		cmocka_unit_test(a_face_of_three_tetrahedra_is_refused_by_name),
		cmocka_unit_test(bad_indices_are_refused),
		cmocka_unit_test(nothing_makes_an_empty_table),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
