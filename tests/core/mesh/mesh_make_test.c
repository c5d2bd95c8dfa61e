// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_text.h"

#include <math.h>
#include <stdbool.h>
#include <sys/stat.h>
#include <unistd.h>

// Largest error of a coordinate: rounding of one product and one sum, for numbers near 1.
static const double place_tolerance = 1e-15;

static const char triangle_file[] = "v 0 0 0\nv 10 0 0\nv 0 20 0\nv 5 5 5\nf 1 2 3\n";

static cau_mesh_def bytes_def(const char *name, const char *text)
{
	cau_mesh_def def = fixture_def(1, 1, 1);
	def.source = CAU_MESH_BYTES;
	snprintf(def.file, sizeof def.file, "%s", name);
	def.bytes = text;
	def.byte_count = strlen(text);
	return def;
}

static void what_is_read_is_scaled_moved_and_cleaned(void **state)
{
	(void)state;
	cau_mesh_def def = bytes_def("up.obj", triangle_file);
	def.unit_m = 0.001;
	memcpy(def.translate_m, (double[]){1, 2, 3}, sizeof def.translate_m);
	cau_mesh mesh;
	cau_mesh_report report;
	assert_int_equal(cau_mesh_make(&def, "", &mesh, &report, NULL), CAU_OK);
	assert_int_equal(report.unused_vertices, 1);
	assert_int_equal(mesh.vertex_count, 3);
	const double expected[] = {1, 2, 3, 1.01, 2, 3, 1, 2.02, 3};
	for (int i = 0; i < 9; i++)
		assert_true(fabs(mesh.position[i] - expected[i]) < place_tolerance);
	cau_mesh_finish(&mesh);
}

static void generated_meshes_are_moved_but_not_scaled(void **state)
{
	(void)state;
	static const struct {
		int source, vertex_count;
	} cases[] = {{CAU_MESH_SHEET, 12}, {CAU_MESH_SLAB, 60}, {CAU_MESH_PATTERN, 4}};
	for (int i = 0; i < 3; i++) {
		cau_mesh_def def = fixture_def(3, 2, 4);
		def.source = cases[i].source;
		def.unit_m = 0.001;
		def.translate_m[2] = 0.5;
		cau_mesh mesh;
		cau_error error = {0};
		if (cau_mesh_make(&def, "", &mesh, NULL, &error))
			fail_msg("%s", error.reason);
		assert_int_equal(mesh.vertex_count, cases[i].vertex_count);
		double highest = 0, widest = 0;
		for (int v = 0; v < mesh.vertex_count; v++) {
			highest = fmax(highest, mesh.position[3 * v + 2]);
			widest = fmax(widest, mesh.position[3 * v]);
		}
		assert_true(highest == 0.5);
		assert_true(fabs(widest - 0.06) < place_tolerance);
		cau_mesh_finish(&mesh);
	}
}

static void files_are_found_from_the_directory(void **state)
{
	(void)state;
	char directory[] = "/tmp/cautery_mesh_XXXXXX", path[80], pipe_path[80];
	assert_non_null(mkdtemp(directory));
	snprintf(path, sizeof path, "%s/a.obj", directory);
	snprintf(pipe_path, sizeof pipe_path, "%s/p.obj", directory);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(triangle_file, file);
	fclose(file);
	assert_int_equal(mkfifo(pipe_path, 0600), 0);

	static const struct {
		const char *directory, *file;
		cau_status status;
		const char *part;
	} cases[] = {
		{"here", "a.obj", CAU_OK, ""},
		{"", "here/a.obj", CAU_OK, ""},
		{"elsewhere", "here/a.obj", CAU_OK, ""},
		{"here", "b.obj", CAU_IO, "No such file"},
		{"here", ".", CAU_IO, "not a regular file"},
		{"here", "p.obj", CAU_IO, "not a regular file"},
		{"here", "a.stl", CAU_OK, ""}, // the ending of a name does not decide the format
	};
	char other[80];
	snprintf(other, sizeof other, "%s/a.stl", directory);
	assert_int_equal(link(path, other), 0);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		cau_mesh_def def = bytes_def("", "");
		def.source = CAU_MESH_FILE;
		def.unit_m = 0.001;
		bool absolute = !strncmp(cases[i].file, "here/", 5);
		snprintf(def.file, sizeof def.file, "%s%s", absolute ? directory : "",
		         absolute ? cases[i].file + 4 : cases[i].file);
		const char *from = !strcmp(cases[i].directory, "here") ? directory : cases[i].directory;
		cau_mesh mesh;
		cau_error error = {0};
		cau_status status = cau_mesh_make(&def, from, &mesh, NULL, &error);
		if (status != cases[i].status || !strstr(error.reason, cases[i].part))
			fail_msg("%s: %s: %s", def.file, cau_status_name(status), error.reason);
		if (status)
			assert_string_equal(error.file, def.file);
		cau_mesh_finish(&mesh);
	}
	unlink(path);
	unlink(pipe_path);
	unlink(other);
	rmdir(directory);
}

static void refuse(cau_mesh_def def, cau_status expected, const char *path, const char *part)
{
	cau_mesh mesh;
	cau_error error = {0};
	assert_int_equal(cau_mesh_make(&def, "", &mesh, NULL, &error), expected);
	assert_string_equal(error.path, path);
	if (!strstr(error.reason, part))
		fail_msg("'%s' lacks '%s'", error.reason, part);
	assert_null(mesh.position);
}

static void bad_definitions_are_refused(void **state)
{
	(void)state;
	const double units[] = {0, -1, NAN, INFINITY};
	for (int i = 0; i < 4; i++) {
		cau_mesh_def def = bytes_def("a.obj", triangle_file);
		def.unit_m = units[i];
		refuse(def, CAU_BAD_VALUE, "unit_m", "above zero");
	}
	cau_mesh_def def = bytes_def("a.obj", triangle_file);
	def.translate_m[1] = NAN;
	refuse(def, CAU_BAD_VALUE, "translate_m", "finite");
	def = bytes_def("a.obj", triangle_file);
	def.unit_m = 1e9;
	refuse(def, CAU_BAD_MESH, "", "check unit_m");
	def.unit_m = 1e308;
	refuse(def, CAU_BAD_MESH, "", "not finite");
	def.unit_m = 1;
	refuse(def, CAU_BAD_MESH, "unit_m", "did you mean millimetres (unit_m 0.001)?");
	def = bytes_def("a", "a letter");
	refuse(def, CAU_UNSUPPORTED, "", "'a' has none of the supported formats");
	def = bytes_def("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
	refuse(def, CAU_BAD_MESH, "", "every element is degenerate");
	def.bytes = NULL;
	def.byte_count = 0;
	refuse(def, CAU_BAD_SYNTAX, "", "is empty");
	def = fixture_def(2, 2, 2);
	def.source = 99;
	refuse(def, CAU_BAD_VALUE, "source", "no kind of mesh source");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_read_is_scaled_moved_and_cleaned),
		cmocka_unit_test(generated_meshes_are_moved_but_not_scaled),
		cmocka_unit_test(files_are_found_from_the_directory),
		cmocka_unit_test(bad_definitions_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
