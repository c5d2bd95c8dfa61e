// SPDX-License-Identifier: GPL-3.0-or-later
// Tests profiles of instruments, and scenes and commands with tools that name an instrument.
#include "json/document.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/command_json.h"
#include "cautery/defaults.h"
#include "cautery/scene_json.h"

static cau_instrument instrument_of(const char *name)
{
	cau_instrument instrument;
	cau_error error = {0};
	int32_t index = 0;
	while (index < cau_instrument_count() && strcmp(cau_instrument_name(index), name) != 0)
		index++;
	assert_in_range(index, 0, cau_instrument_count() - 1);
	if (cau_instrument_read(index, &instrument, &error))
		fail_msg("%s: %s: %s", name, error.path, error.reason);
	return instrument;
}

static const cau_instrument_mode *mode_of(const cau_instrument *instrument, const char *name)
{
	for (int32_t m = 0; m < instrument->mode_count; m++)
		if (strcmp(instrument->modes[m].name, name) == 0)
			return &instrument->modes[m];
	fail_msg("%s has no mode %s", instrument->name, name);
	return NULL;
}

// Checks the peaks and crest factors of all profiles. The mean voltage of a mode is at most that of
// the mode `cut`. A mode that must not spark stays below 200 V.
static void every_profile_is_read(void **state)
{
	(void)state;
	static const char *const names[] = {"advanced-bipolar",  "bipolar-forceps",
	                                    "monopolar-hook",    "monopolar-needle",
	                                    "monopolar-spatula", "ultrasonic-shears"};
	assert_int_equal(cau_instrument_count(), sizeof names / sizeof names[0]);
	for (int32_t i = 0; i < cau_instrument_count(); i++) {
		assert_string_equal(cau_instrument_name(i), names[i]);
		cau_instrument instrument = instrument_of(names[i]);
		assert_true(instrument.description[0]);
		for (int32_t m = 0; m < instrument.mode_count; m++) {
			const cau_instrument_mode *mode = &instrument.modes[m];
			assert_true(mode->description[0] && mode->power_least_w < mode->power_most_w);
			assert_true(mode->tool.blade_heat_j_k >= 0.01 && mode->tool.blade_cooling_w_k > 0);
			assert_true(mode->tool.peak_v / mode->tool.crest_factor < 1150 / 1.4 + 1);
			assert_true(mode->tool.shape != CAU_TOOL_BIPOLAR || mode->tool.peak_v < 200);
		}
	}
}

// Checks the share of time that a generator is on. It follows from the crest factor: 2 / crest^2.
static void modes_have_the_duty_of_their_name(void **state)
{
	(void)state;
	static const char *const names[] = {"monopolar-hook", "monopolar-needle", "monopolar-spatula"};
	static const struct {
		const char *mode;
		double least, most;
	} duties[] = {{"cut", 0.98, 1.03}, {"blend", 0.45, 0.55}, {"coagulation", 0.055, 0.105}};
	for (int i = 0; i < 3; i++) {
		cau_instrument instrument = instrument_of(names[i]);
		for (int m = 0; m < 3; m++) {
			double crest = mode_of(&instrument, duties[m].mode)->tool.crest_factor;
			assert_true(2 / (crest * crest) > duties[m].least);
			assert_true(2 / (crest * crest) < duties[m].most);
		}
	}
}

static void a_mode_is_put_in_the_place_of_its_name(void **state)
{
	(void)state;
	cau_tool_def tool;
	cau_error error = {0};
	cau_default_tool_def(&tool, CAU_TOOL_GRASPER);
	strcpy(tool.name, "mine");
	tool.pose.position_m[0] = 0.25;
	assert_int_equal(cau_instrument_take("monopolar-hook", "coagulation", -1, &tool, &error),
	                 CAU_OK);
	cau_instrument hook = instrument_of("monopolar-hook");
	const cau_tool_def *wanted = &mode_of(&hook, "coagulation")->tool;
	assert_string_equal(tool.name, "mine");
	assert_true(tool.pose.position_m[0] == 0.25 && tool.shape == CAU_TOOL_HOOK);
#define SAME(field, ...) assert_true(tool.field == wanted->field);
	CAU_TOOL_TABLE(SAME)
#undef SAME
	assert_int_equal(cau_instrument_take("monopolar-hook", NULL, 12, &tool, &error), CAU_OK);
	assert_true(tool.power_w == 12 && tool.peak_v == mode_of(&hook, "cut")->tool.peak_v);
	cau_tool_def before = tool;
	assert_int_equal(cau_instrument_take("monopolar-hook", "cut", 151, &tool, &error),
	                 CAU_BAD_VALUE);
	assert_string_equal(error.path, "power_w");
	assert_memory_equal(&tool, &before, sizeof tool);
}

// ---- scenes

#define TOOL(members) "{\"name\":\"s\",\"tools\":[{\"name\":\"t\"," members "}]}"

static cau_status read_tool(const char *text, cau_tool_def *tool, cau_error *error)
{
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(scene);
	cau_status status = cau_scene_from_json("x", text, strlen(text), scene, error);
	*tool = scene->tools[0];
	free(scene);
	return status;
}

static void a_scene_s_tool_is_an_instrument(void **state)
{
	(void)state;
	cau_tool_def tool;
	cau_error error = {0};
	const char *text =
		TOOL("\"instrument\":\"bipolar-forceps\",\"power_w\":40,\"tip_length_m\":0.012");
	if (read_tool(text, &tool, &error))
		fail_msg("%s: %s", error.path, error.reason);
	cau_instrument forceps = instrument_of("bipolar-forceps");
	const cau_tool_def *wanted = &forceps.modes[0].tool;
	assert_string_equal(tool.name, "t");
	assert_int_equal(tool.shape, CAU_TOOL_BIPOLAR);
	// members of the tool override the instrument
	assert_true(tool.power_w == 40 && tool.tip_length_m == 0.012);
	assert_true(tool.peak_v == wanted->peak_v && tool.blade_heat_j_k == wanted->blade_heat_j_k);
	text = TOOL("\"mode\":\"level-3\",\"shape\":\"capsule\",\"instrument\":\"ultrasonic-shears\"");
	assert_int_equal(read_tool(text, &tool, &error), CAU_OK);
	cau_instrument shears = instrument_of("ultrasonic-shears");
	assert_int_equal(tool.shape, CAU_TOOL_CAPSULE);
	assert_true(tool.power_w == mode_of(&shears, "level-3")->tool.power_w);
}

// A written scene has only numbers. It names no instrument and reads back to the same scene.
static void what_is_written_has_numbers(void **state)
{
	(void)state;
	static char text[1 << 16];
	cau_scene_def *first = malloc(sizeof *first), *second = malloc(sizeof *second);
	const char *given = TOOL("\"instrument\":\"monopolar-needle\",\"mode\":\"blend\"");
	size_t bytes = 0;
	assert_true(first && second);
	assert_int_equal(cau_scene_from_json("x", given, strlen(given), first, NULL), CAU_OK);
	assert_int_equal(cau_scene_to_json(first, text, sizeof text, &bytes, NULL), CAU_OK);
	assert_null(strstr(text, "instrument"));
	assert_null(strstr(text, "blend"));
	assert_int_equal(cau_scene_from_json("x", text, bytes, second, NULL), CAU_OK);
	assert_memory_equal(first, second, sizeof *first);
	free(first);
	free(second);
}

static void a_tool_that_is_none_is_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *path, *reason;
	} rows[] = {
		{TOOL("\"instrument\":\"monopolar-hok\""), "tools[0].instrument",
	     "\"monopolar-hok\" is none of advanced-bipolar, bipolar-forceps, monopolar-hook, "
	     "monopolar-needle, monopolar-spatula, ultrasonic-shears; did you mean "
	     "\"monopolar-hook\"?"},
		{TOOL("\"instrument\":3"), "tools[0].instrument", "a string is needed, not 3"},
		{TOOL("\"instrument\":\"monopolar-hook\",\"mode\":\"seal\""), "tools[0].mode",
	     "\"seal\" is none of cut, blend, coagulation"},
		{TOOL("\"shape\":\"hook\",\"mode\":\"cut\""), "tools[0].mode",
	     "a mode needs the member instrument, which names the instrument"},
		{TOOL("\"power_w\":3"), "tools[0].shape", "missing: a string is needed"},
		{TOOL("\"instrument\":\"monopolar-hook\",\"mode\":\"coagulation\",\"power_w\":76"),
	     "tools[0].power_w", "76 is not between 1 and 75 W, which the mode \"coagulation\" has"},
		{TOOL("\"instrument\":\"monopolar-hook\",\"power\":7"), "tools[0].power",
	     "unknown: did you mean \"power_w\"?"},
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		cau_tool_def tool;
		cau_error error = {0};
		assert_int_equal(read_tool(rows[i].text, &tool, &error), CAU_BAD_VALUE);
		assert_string_equal(error.path, rows[i].path);
		assert_string_equal(error.reason, rows[i].reason);
	}
}

// ---- commands

static void a_command_may_name_an_instrument(void **state)
{
	(void)state;
	cau_command command;
	cau_error error = {0};
	const char *text = "{\"command\":\"tool.configure\",\"tool\":\"t\","
					   "\"instrument\":\"advanced-bipolar\",\"mode\":\"seal\",\"friction\":0.5}";
	if (cau_command_from_json(text, strlen(text), &command, &error))
		fail_msg("%s: %s", error.path, error.reason);
	assert_string_equal(command.tool, "t");
	assert_int_equal(command.as.definition.shape, CAU_TOOL_BIPOLAR);
	assert_true(command.as.definition.load_rise_off == 4 && command.as.definition.friction == 0.5);
	text = "{\"command\":\"tool.add\",\"name\":\"n\",\"instrument\":\"ultrasonic-shears\"}";
	assert_int_equal(cau_command_from_json(text, strlen(text), &command, &error), CAU_OK);
	assert_string_equal(command.as.definition.name, "n");
	assert_int_equal(command.as.definition.shape, CAU_TOOL_SHEARS);
	text = "{\"command\":\"tool.add\",\"name\":\"n\",\"instrument\":\"scissors\"}";
	assert_int_equal(cau_command_from_json(text, strlen(text), &command, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "instrument");
	text = "{\"command\":\"tool.energize\",\"tool\":\"t\",\"energized\":true,\"mode\":\"cut\"}";
	assert_int_equal(cau_command_from_json(text, strlen(text), &command, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "mode");
}

// ---- invalid profiles

#define PROFILE(tool, sources, modes)                                                              \
	"{\"name\":\"p\",\"description\":\"d\",\"tool\":" tool ",\"sources\":" sources                 \
	",\"modes\":[" modes "]}"
#define MODE(members)                                                                              \
	"{\"name\":\"m\",\"description\":\"d\",\"power_least_w\":1,\"power_most_w\":9" members "}"
#define GOOD MODE(",\"power_w\":3,\"sources\":{\"power_w\":\"read\"}")

static void a_number_without_a_source_is_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *path;
	} rows[] = {
		{PROFILE("{\"shape\":\"hook\",\"tip_length_m\":0.008}", "{}", GOOD),
	     "sources.tip_length_m"},
		{PROFILE("{\"shape\":\"hook\"}", "{\"tip_length_m\":\"read\"}", GOOD),
	     "sources.tip_length_m"},
		{PROFILE("{\"shape\":\"hook\",\"tip_length_m\":0.008}", "{\"tip_length_m\":\"\"}", GOOD),
	     "sources.tip_length_m"},
		{PROFILE("{\"tip_length_m\":0.008}", "{\"tip_length_m\":\"read\"}", GOOD), "tool.shape"},
		{PROFILE("{\"shape\":\"hook\"}", "{}", ""), "modes"},
		{PROFILE("{\"shape\":\"hook\"}", "{}", MODE(",\"power_w\":3")), "modes[0].sources"},
		{PROFILE("{\"shape\":\"hook\"}", "{}", MODE(",\"power_w\":3,\"sources\":{}")),
	     "modes[0].sources.power_w"},
		{PROFILE("{\"shape\":\"hook\"}", "{}",
	             MODE(",\"power_w\":10,\"sources\":{\"power_w\":\"read\"}")),
	     "modes[0].power_w"},
		{PROFILE("{\"shape\":\"hook\"}", "{}",
	             MODE(",\"friction\":1,\"sources\":{\"friction\":\"read\"}")),
	     "modes[0].friction"},
	};
	cau_instrument instrument;
	cau_error error = {0};
	const char *good = PROFILE("{\"shape\":\"hook\"}", "{}", GOOD);
	assert_int_equal(cau_instrument_from_json("p", good, strlen(good), &instrument, &error),
	                 CAU_OK);
	assert_int_equal(cau_instrument_from_json("q", good, strlen(good), &instrument, &error),
	                 CAU_BAD_VALUE);
	assert_string_equal(error.path, "name");
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		assert_int_equal(
			cau_instrument_from_json("p", rows[i].text, strlen(rows[i].text), &instrument, &error),
			CAU_BAD_VALUE);
		assert_string_equal(error.path, rows[i].path);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_profile_is_read),
		cmocka_unit_test(modes_have_the_duty_of_their_name),
		cmocka_unit_test(a_mode_is_put_in_the_place_of_its_name),
		cmocka_unit_test(a_scene_s_tool_is_an_instrument),
		cmocka_unit_test(what_is_written_has_numbers),
		cmocka_unit_test(a_tool_that_is_none_is_refused),
		cmocka_unit_test(a_command_may_name_an_instrument),
		cmocka_unit_test(a_number_without_a_source_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
