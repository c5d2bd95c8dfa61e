// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/writers.h"

#include "sim_fixture.h"

typedef struct data {
	const char *at;
	uint64_t bytes;
} data;

// Returns the bytes of the array with this name, found by its offset in the appended block.
static data find_array(const char *text, size_t bytes, const char *name)
{
	char attribute[64];
	uint64_t offset;
	snprintf(attribute, sizeof attribute, "Name=\"%s\"", name);
	const char *place = strstr(text, attribute);
	assert_non_null(place);
	place = strstr(place, "offset=\"");
	assert_non_null(place);
	assert_int_equal(sscanf(place, "offset=\"%lu\"", &offset), 1);
	const char *block = strstr(text, "encoding=\"raw\">\n_");
	assert_non_null(block);
	block += strlen("encoding=\"raw\">\n_");
	data found;
	memcpy(&found.bytes, block + offset, sizeof found.bytes);
	found.at = block + offset + sizeof found.bytes;
	assert_true((size_t)(found.at - text) + found.bytes <= bytes);
	return found;
}

static void a_file_holds_the_drawn_tissue(void **state)
{
	(void)state;
	cau_scene_def *scene = fixture_scene();
	cau_session_def def = cau_default_session_def();
	cau_session *session;
	cau_session_info info;
	cau_frame frame;
	cau_error error = {0};
	sim_vtu vtu;
	size_t bytes;
	def.scene = scene;
	assert_int_equal(cau_session_create(&def, &session, &error), CAU_OK);
	cau_session_describe(session, &info);
	assert_int_equal(sim_vtu_begin(fixture_path("vtu"), &vtu, &error), CAU_OK);
	assert_int_equal(sim_vtu_write(&vtu, session, &error), CAU_OK);
	cau_session_frame(session, &frame);

	char *text = fixture_read(fixture_path("vtu/tissue-00000000.vtu"), &bytes);
	char counts[96];
	snprintf(counts, sizeof counts, "NumberOfPoints=\"%d\" NumberOfCells=\"%d\"", info.vertex_count,
	         info.face_count);
	assert_non_null(strstr(text, counts));
	data position = find_array(text, bytes, "position_m");
	assert_int_equal(position.bytes, 24 * (size_t)info.vertex_count);
	assert_memory_equal(position.at, frame.position, position.bytes);
	data corner = find_array(text, bytes, "connectivity"), end = find_array(text, bytes, "offsets");
	data type = find_array(text, bytes, "types");
	assert_int_equal(corner.bytes, 24 * (size_t)info.face_count);
	for (int32_t i = 0; i < info.face_count; i++) {
		int64_t vertex[3], last;
		memcpy(vertex, corner.at + 24 * (size_t)i, sizeof vertex);
		memcpy(&last, end.at + 8 * (size_t)i, sizeof last);
		for (int k = 0; k < 3; k++)
			assert_int_equal(vertex[k], info.face[3 * i + k]);
		assert_int_equal(last, 3 * (i + 1));
		assert_int_equal(type.at[i], 5); // VTK_TRIANGLE
	}
	free(text);

	for (int i = 0; i < 60; i++)
		assert_int_equal(cau_session_step(session, &error), CAU_OK);
	assert_int_equal(sim_vtu_write(&vtu, session, &error), CAU_OK);
	assert_int_equal(sim_vtu_finish(&vtu, &error), CAU_OK);
	text = fixture_read(fixture_path("vtu/cautery.pvd"), &bytes);
	assert_non_null(
		strstr(text, "<DataSet timestep=\"0\" part=\"0\" file=\"tissue-00000000.vtu\"/>"));
	assert_non_null(
		strstr(text, "<DataSet timestep=\"1\" part=\"0\" file=\"tissue-00000060.vtu\"/>"));
	assert_non_null(
		strstr(text, "<DataSet timestep=\"1\" part=\"1\" file=\"tools-00000060.vtu\"/>"));
	free(text);
	cau_session_destroy(session);
	free(scene);
}

static double number_at(data array, size_t index)
{
	double value;
	assert_true(8 * (index + 1) <= array.bytes);
	memcpy(&value, array.at + 8 * index, sizeof value);
	return value;
}

static void energize_hook(cau_session *session)
{
	cau_error error = {0};
	cau_command command = {.kind = CAU_COMMAND_TOOL_ENERGIZE, .as.energized = true};
	snprintf(command.tool, sizeof command.tool, "hook");
	assert_int_equal(cau_session_submit(session, &command, &error), CAU_OK);
	assert_int_equal(cau_session_step(session, &error), CAU_OK);
}

// In the double, every vertex has 37 for an observed scalar, and the hook has 170 degC.
static void files_tell_scalars_and_tools(void **state)
{
	(void)state;
	cau_scene_def *scene = fixture_scene();
	cau_session_def def = cau_default_session_def();
	cau_session *session;
	cau_frame frame;
	cau_error error = {0};
	sim_vtu vtu;
	size_t bytes;
	def.scene = scene;
	assert_int_equal(cau_session_create(&def, &session, &error), CAU_OK);
	energize_hook(session);
	assert_int_equal(sim_vtu_begin(fixture_path("tools"), &vtu, &error), CAU_OK);
	assert_int_equal(sim_vtu_write(&vtu, session, &error), CAU_OK);
	cau_session_frame(session, &frame);
	assert_null(frame.stress); // the stress was observed only for the file

	char *text = fixture_read(fixture_path("tools/tissue-00000001.vtu"), &bytes);
	for (const char *const *name = (const char *const[]){"temperature_c", "stress_pa", NULL}; *name;
	     name++) {
		float value;
		data array = find_array(text, bytes, *name);
		assert_int_equal(array.bytes * 6, find_array(text, bytes, "position_m").bytes);
		memcpy(&value, array.at, sizeof value);
		assert_float_equal(value, 37, 0);
	}
	const struct {
		const char *name;
		const void *value;
	} drawn[] = {{"exposure", frame.exposure}, {"charring", frame.charring}};
	for (int i = 0; i < 2; i++) {
		data array = find_array(text, bytes, drawn[i].name);
		assert_int_equal(array.bytes * 6, find_array(text, bytes, "position_m").bytes);
		assert_memory_equal(array.at, drawn[i].value, array.bytes);
	}
	free(text);

	text = fixture_read(fixture_path("tools/tools-00000001.vtu"), &bytes);
	const cau_tool_state *hook = &frame.tools[0];
	data position = find_array(text, bytes, "position_m");
	assert_int_equal(position.bytes, 2 * 24);
	// The shaft is upright, so its end is above the tip.
	for (size_t c = 0; c < 3; c++)
		assert_float_equal((float)(number_at(position, 3 + c) - number_at(position, c)),
		                   c == 2 ? (float)hook->definition.shaft_length_m : 0, 1e-7F);
	assert_true(number_at(position, 2) == hook->pose.position_m[2]);
	assert_true(number_at(find_array(text, bytes, "temperature_c"), 0) == 170);
	assert_int_equal(*find_array(text, bytes, "energized").at, 1);
	assert_int_equal(find_array(text, bytes, "force_n").bytes, 24);
	free(text);
	assert_int_equal(sim_vtu_finish(&vtu, &error), CAU_OK);
	cau_session_destroy(session);
	free(scene);
}

static void a_folder_that_cannot_be_is_an_error(void **state)
{
	(void)state;
	sim_vtu vtu;
	cau_error error = {0};
	assert_int_equal(sim_vtu_begin("/nowhere/at/all", &vtu, &error), CAU_IO);
	assert_string_equal(error.file, "/nowhere/at/all");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_file_holds_the_drawn_tissue),
		cmocka_unit_test(files_tell_scalars_and_tools),
		cmocka_unit_test(a_folder_that_cannot_be_is_an_error),
	};
	return cmocka_run_group_tests(tests, NULL, fixture_remove);
}
