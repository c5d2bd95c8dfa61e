// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_text.h"

#define SQUARE "v 0 0 0\nv 1 0 0 # comment\nv 1 1 0 1.0 0.5 0.5\nv 0 1 0\n"
#define UV "vt 0 0\nvt 1 0 0\nvt 1 1\nvt 0.25\n"

static void polygons_become_fans_with_texture(void **state)
{
	(void)state;
	cau_mesh mesh;
	cau_error error;
	assert_int_equal(read_text("a.obj",
	                           "# a square\r\n" SQUARE UV "vn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1",
	                           &mesh, &error),
	                 CAU_OK);
	assert_int_equal(mesh.vertex_count, 4);
	assert_int_equal(mesh.triangle_count, 2);
	assert_memory_equal(mesh.triangle, ((int32_t[]){0, 1, 2, 0, 2, 3}), 6 * sizeof(int32_t));
	const double texture[] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0.25, 0};
	assert_memory_equal(mesh.texture, texture, sizeof texture);
	cau_mesh_finish(&mesh);
}

static void corners_are_written_in_four_ways(void **state)
{
	(void)state;
	static const char *const faces[] = {
		"f 1 2 3\n",
		"f 1/1 2/2 3/3\n",
		"f 1//1 2//1 3//1\n",
		"f 1/1/1 2/2/1 3/3/1\n",
		"f -4 -3 -2\n",
		"f -4/-4/-1 -3/-3/-1 -2/-2/-1\n",
		"f 1/1 \\\n 2/2 \\\r\n 3/3\n",
	};
	for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
		char text[400];
		snprintf(text, sizeof text, "%s%s%s", SQUARE UV, "vn 0 0 1\n", faces[i]);
		cau_mesh mesh;
		cau_error error;
		if (read_text("a.obj", text, &mesh, &error))
			fail_msg("%s: %s", faces[i], error.reason);
		assert_int_equal(mesh.triangle_count, 1);
		assert_memory_equal(mesh.triangle, ((int32_t[]){0, 1, 2}), 3 * sizeof(int32_t));
		int has_texture = strstr(faces[i], "1/1") || strstr(faces[i], "/-4");
		assert_int_equal(mesh.texture != NULL, has_texture);
		cau_mesh_finish(&mesh);
	}
}

static void texture_needs_every_corner(void **state)
{
	(void)state;
	cau_mesh mesh;
	cau_error error;
	assert_int_equal(read_text("a.obj", SQUARE UV "f 1/1 2/2 3/3\nf 1 3 4\n", &mesh, &error),
	                 CAU_OK);
	assert_int_equal(mesh.triangle_count, 2);
	assert_null(mesh.texture);
	cau_mesh_finish(&mesh);
}

static void check_regions(const char *text, const int32_t expected[4])
{
	cau_mesh mesh;
	cau_error error;
	if (read_text("a.obj", text, &mesh, &error))
		fail_msg("%s", error.reason);
	assert_int_equal(mesh.triangle_count, 4);
	assert_memory_equal(mesh.triangle_region, expected, 4 * sizeof *expected);
	cau_mesh_finish(&mesh);
}

static void materials_number_the_regions_before_groups(void **state)
{
	(void)state;
	check_regions(SQUARE "g a\nf 1 2 3\nusemtl skin tone\nf 1 2 4\ng b\nusemtl skin pale\nf 2 3 4\n"
	                     "usemtl skin tone \nf 1 3 4\n",
	              (int32_t[]){0, 1, 2, 1});
	check_regions(SQUARE "f 1 2 3\ng a\nf 1 2 4\ng b\nf 2 3 4\ng a\nf 1 3 4\n",
	              (int32_t[]){0, 1, 2, 1});
}

static void failures_name_line_and_reason(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		cau_status status;
		const char *part;
	} cases[] = {
		{"", CAU_BAD_SYNTAX, "is empty"},
		{SQUARE "l 1 2\np 3\n", CAU_BAD_MESH, "but 4 vertices, 1 lines, 1 points"},
		{SQUARE "f 1 2\n", CAU_BAD_MESH, "but 4 vertices, 1 faces of fewer than 3 corners"},
		{SQUARE "f\n", CAU_BAD_MESH, "1 faces of fewer than 3 corners"},
		{SQUARE "f 1 2 5\n", CAU_BAD_MESH,
	     "line 5: 5 as a vertex number: the file has only 4 so far"},
		{SQUARE "f 1 2 0\n", CAU_BAD_MESH, "line 5: 0 as a vertex number"},
		{SQUARE "f 1 2 -5\n", CAU_BAD_MESH, "line 5: -5 as a vertex number"},
		{SQUARE "f 1/1 2 3\n", CAU_BAD_MESH, "1 as a texture number: the file has only 0 so far"},
		{SQUARE "f 1 2 99999999999\n", CAU_BAD_SYNTAX, "but found 99999999999"},
		{SQUARE "f 1 2 x\n", CAU_BAD_SYNTAX, "found 'x'"},
		{"v 0 0\nv 1 0 0\n", CAU_BAD_SYNTAX, "line 1: expected a coordinate, found nothing"},
		{"v 0 0 -NaN\n", CAU_BAD_MESH, "line 1: vertex 0: its z is not finite"},
		{"v 0 0 1e999\n", CAU_BAD_MESH, "line 1: vertex 0: its z is not finite"},
		{"vt\n", CAU_BAD_SYNTAX, "line 1: expected a texture coordinate"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		refuse_text("a.obj", cases[i].text, cases[i].status, cases[i].part);
}

static void too_many_materials_are_refused(void **state)
{
	(void)state;
	static char text[8192] = SQUARE;
	for (int i = 0; i < 257; i++)
		snprintf(text + strlen(text), 24, "usemtl m%d\n", i);
	refuse_text("a.obj", text, CAU_LIMIT, "line 261: more than 256 names");
}

// One corner more than the limit of 2^20.
static void a_face_of_too_many_corners_is_refused(void **state)
{
	(void)state;
	const size_t corners = (1 << 20) + 1, before = strlen(SQUARE "f");
	char *text = malloc(before + 2 * corners + 1);
	assert_non_null(text);
	memcpy(text, SQUARE "f", before);
	for (size_t i = 0; i < corners; i++)
		memcpy(text + before + 2 * i, " 1", 2);
	text[before + 2 * corners] = 0;
	refuse_text("a.obj", text, CAU_LIMIT, "a face has more than 1048576 corners");
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(polygons_become_fans_with_texture),
		cmocka_unit_test(corners_are_written_in_four_ways),
		cmocka_unit_test(texture_needs_every_corner),
		cmocka_unit_test(materials_number_the_regions_before_groups),
		cmocka_unit_test(failures_name_line_and_reason),
		cmocka_unit_test(too_many_materials_are_refused),
		cmocka_unit_test(a_face_of_too_many_corners_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
