// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/embed.h"

#include "cautery/scene_json.h"
#include "server/sim/sim_fixture.h"

#define SHEET(mesh)                                                                                \
	"{\"name\": \"small\", \"meshes\": [{\"name\": \"sheet\", " mesh "}],"                         \
	" \"layers\": [{\"kind\": \"fascia\", \"name\": \"fascia\", \"mesh\": \"sheet\"}],"            \
	" \"pins\": [{\"kind\": \"rim\", \"layer\": \"fascia\"}],"                                     \
	" \"tools\": [{\"name\": \"hook\", \"shape\": \"hook\"}]}"

static const char generated[] = SHEET("\"source\": \"sheet\", \"cells\": [4, 4]");
static const char of_a_file[] = SHEET("\"source\": \"file\", \"file\": \"sheet.obj\"");
static const char square[] = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n";

static uint64_t hash_after(cau_session *session, int ticks)
{
	for (int tick = 0; tick < ticks; tick++)
		assert_int_equal(cau_session_step(session, NULL), CAU_OK);
	uint64_t hash = cau_session_hash(session);
	cau_session_destroy(session);
	return hash;
}

static void file_text_and_definition_make_the_same_session(void **state)
{
	(void)state;
	const char *path = fixture_path("small.json");
	cau_session *session = NULL;
	cau_error error = {0};
	fixture_write(path, generated);
	assert_int_equal(cau_session_from_file(path, NULL, &session, &error), CAU_OK);
	uint64_t of_file = hash_after(session, 20);
	assert_int_equal(
		cau_session_from_json(NULL, generated, sizeof generated - 1, NULL, NULL, &session, &error),
		CAU_OK);
	assert_true(of_file == hash_after(session, 20));

	cau_scene_def *scene = malloc(sizeof *scene);
	assert_int_equal(cau_scene_from_json(NULL, generated, sizeof generated - 1, scene, &error),
	                 CAU_OK);
	cau_session_def def = cau_default_session_def();
	def.scene = scene;
	assert_int_equal(cau_session_create(&def, &session, &error), CAU_OK);
	assert_true(of_file == hash_after(session, 20));
	free(scene);
}

static void mesh_files_are_looked_up_beside_the_scene(void **state)
{
	(void)state;
	const char *path = fixture_path("mesh.json");
	cau_session *session = NULL;
	cau_session_info info;
	cau_error error = {0};
	fixture_write(path, of_a_file);
	assert_int_equal(cau_session_from_file(path, NULL, &session, &error), CAU_IO);
	assert_non_null(strstr(error.file, "sheet.obj"));
	assert_null(session);
	fixture_write(fixture_path("sheet.obj"), square);
	assert_int_equal(cau_session_from_file(path, NULL, &session, &error), CAU_OK);
	cau_session_describe(session, &info);
	assert_int_equal(info.vertex_count, 4);
	cau_session_destroy(session);
	assert_int_equal(cau_session_from_json("x", of_a_file, sizeof of_a_file - 1, fixture_folder(),
	                                       NULL, &session, &error),
	                 CAU_OK);
	cau_session_destroy(session);
}

static void expect_error(const char *text, cau_status status, const char *path, const char *reason)
{
	cau_session *session = NULL;
	cau_error error = {0};
	assert_int_equal(
		cau_session_from_json("scene.json", text, strlen(text), NULL, NULL, &session, &error),
		status);
	assert_null(session);
	assert_string_equal(error.file, "scene.json");
	assert_string_equal(error.path, path);
	if (!strstr(error.reason, reason))
		fail_msg("\"%s\" does not say \"%s\"", error.reason, reason);
}

static void a_bad_scene_is_named_with_the_place_in_it(void **state)
{
	(void)state;
	expect_error("{\"name\": \"small\", \"step_s\": 9}", CAU_BAD_VALUE, "step_s", "outside");
	expect_error("{", CAU_BAD_SYNTAX, "", "");
	expect_error("{\"name\": \"small\"}", CAU_BAD_VALUE, "meshes", "");
	char folder[2000];
	cau_error error = {0};
	cau_session *session = NULL;
	memset(folder, 'a', sizeof folder - 1);
	folder[sizeof folder - 1] = 0;
	assert_int_equal(
		cau_session_from_json("x", generated, sizeof generated - 1, folder, NULL, &session, &error),
		CAU_LIMIT);
	assert_int_equal(cau_session_from_file("/nowhere/a.json", NULL, &session, NULL), CAU_IO);
}

static void commands_are_json(void **state)
{
	(void)state;
	static const char energy[] =
		"{\"command\": \"tool.energize\", \"tool\": \"hook\", \"energized\": true}";
	static const char strange[] = "{\"command\": \"tool.grasp\", \"tool\": \"nothing\"}";
	cau_session *session = NULL;
	cau_frame frame;
	cau_error error = {0};
	cau_session_def def = cau_default_session_def();
	def.command_capacity = 2;
	assert_int_equal(
		cau_session_from_json(NULL, generated, sizeof generated - 1, NULL, &def, &session, &error),
		CAU_OK);
	assert_int_equal(cau_session_submit_json(session, strange, sizeof strange - 1, &error), CAU_OK);
	assert_int_equal(cau_session_submit_json(session, "{}", 2, &error), CAU_BAD_VALUE);
	assert_int_equal(cau_session_submit_json(session, energy, sizeof energy - 1, &error), CAU_OK);
	assert_int_equal(cau_session_submit_json(session, energy, sizeof energy - 1, &error),
	                 CAU_LIMIT);
	assert_int_equal(cau_session_step(session, &error), CAU_OK);
	cau_session_frame(session, &frame);
	assert_true(frame.tools[0].energized);
	assert_int_equal(frame.refusal_count, 1);
	assert_int_equal(frame.refusals[0].status, CAU_NOT_FOUND);
	cau_session_destroy(session);
}

static void the_version_is_a_version(void **state)
{
	(void)state;
	int major, minor, patch;
	assert_int_equal(sscanf(cau_core_version(), "%d.%d.%d", &major, &minor, &patch), 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(file_text_and_definition_make_the_same_session),
		cmocka_unit_test(mesh_files_are_looked_up_beside_the_scene),
		cmocka_unit_test(a_bad_scene_is_named_with_the_place_in_it),
		cmocka_unit_test(commands_are_json),
		cmocka_unit_test(the_version_is_a_version),
	};
	return cmocka_run_group_tests(tests, NULL, fixture_remove);
}
