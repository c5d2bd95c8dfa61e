// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/command_json.h"
#include "cautery/scene_json.h"

static const char *const names[] = {"fascia",         "fat",          "fat-neohookean",
                                    "layers",         "patterns",     "strain-none-off",
                                    "strain-none-on", "strain-x-off", "strain-x-on",
                                    "strain-xy-off",  "strain-xy-on"};

// unit of the last decimal: coordinates in scripts have five decimals
static const double decimal_m = 1e-5;

static char *read_file(const char *folder, const char *name, const char *ending, size_t *bytes)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/%s%s", folder, name, ending);
	FILE *file = fopen(path, "rb");
	char *text = malloc(CAU_SCENE_JSON_MAX_BYTES);
	assert_true(file && text);
	*bytes = fread(text, 1, CAU_SCENE_JSON_MAX_BYTES, file);
	fclose(file);
	return text;
}

static cau_scene_def *load(const char *name)
{
	size_t bytes;
	cau_error error = {0};
	char *text = read_file(CAU_TEST_SCENES, name, ".json", &bytes);
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(scene);
	if (cau_scene_from_json(name, text, bytes, scene, &error))
		fail_msg("%s: %s: %s", name, error.path, error.reason);
	free(text);
	return scene;
}

static double distance(const double a[3], const double b[3])
{
	return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
	            (a[2] - b[2]) * (a[2] - b[2]));
}

// Each script turns energy on once and off once, is in the order of ticks, and is the same each
// time.
static void each_scene_has_a_script(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		size_t bytes, again_bytes;
		char *text, *again;
		cau_scene_def *scene = load(names[i]);
		assert_int_equal(sim_cut_script(scene, &text, &bytes, NULL), CAU_OK);
		assert_int_equal(sim_cut_script(scene, &again, &again_bytes, NULL), CAU_OK);
		assert_int_equal(bytes, again_bytes);
		assert_memory_equal(text, again, bytes);
		cau_script script;
		cau_command command;
		bool end;
		uint64_t tick = 0;
		int on = 0, off = 0, moves = 0;
		cau_script_begin(&script, NULL, text, bytes);
		while (assert_int_equal(cau_script_next(&script, &command, &end, NULL), CAU_OK), !end) {
			assert_string_equal(command.tool, scene->cut.tool);
			assert_true(command.tick >= tick);
			tick = command.tick;
			moves += command.kind == CAU_COMMAND_TOOL_MOVE;
			on += command.kind == CAU_COMMAND_TOOL_ENERGIZE && command.as.energized;
			off += command.kind == CAU_COMMAND_TOOL_ENERGIZE && !command.as.energized;
		}
		assert_true(moves > 100);
		assert_int_equal(on, 1);
		assert_int_equal(off, 1);
		free(again);
		free(text);
		free(scene);
	}
}

// Energy is on from above the tissue until the tool leaves. The tool dwells and moves as long as
// the cut says.
static void the_cut_is_drawn_as_described(void **state)
{
	(void)state;
	cau_scene_def *scene = load("layers");
	const cau_cut_def *cut = &scene->cut;
	char *text;
	size_t bytes;
	cau_script script;
	cau_command command;
	bool end;
	uint64_t on = 0, off = 0, arrived = 0, drawn = 0, last_move = 0;
	double previous[3] = {0}, drawn_m = 0.0;
	assert_int_equal(sim_cut_script(scene, &text, &bytes, NULL), CAU_OK);
	cau_script_begin(&script, NULL, text, bytes);
	while (assert_int_equal(cau_script_next(&script, &command, &end, NULL), CAU_OK), !end) {
		assert_string_equal(command.tool, "hook");
		if (command.kind == CAU_COMMAND_TOOL_ENERGIZE) {
			*(command.as.energized ? &on : &off) = command.tick;
			continue;
		}
		assert_int_equal(command.kind, CAU_COMMAND_TOOL_MOVE);
		const double *at = command.as.move.pose.position_m;
		assert_true(command.tick > last_move);
		if (!arrived && distance(at, cut->from_m) < decimal_m)
			arrived = command.tick;
		else if (arrived && !off) {
			double way_m = distance(at, previous);
			double allowed_m = cut->speed_m_s * (double)(command.tick - last_move) * scene->step_s;
			assert_true(way_m <= allowed_m + 2.0 * decimal_m);
			drawn_m += way_m;
			drawn = command.tick;
		}
		memcpy(previous, at, sizeof previous);
		last_move = command.tick;
	}
	assert_true(on > 0 && on < arrived && arrived < drawn && drawn <= off && off < last_move);
	assert_true(fabs(drawn_m - distance(cut->from_m, cut->to_m)) < 1e-4);
	double seconds = (double)(drawn - arrived) * scene->step_s;
	double wanted_s = cut->dwell_s + distance(cut->from_m, cut->to_m) / cut->speed_m_s;
	// moves are some ticks apart, which allows a small difference
	assert_true(fabs(seconds - wanted_s) < 0.1);
	free(text);
	free(scene);
}

static void a_scene_without_cut_is_refused(void **state)
{
	(void)state;
	char *text;
	size_t bytes;
	cau_error error = {0};
	cau_scene_def *scene = load("fascia");
	snprintf(scene->cut.tool, sizeof scene->cut.tool, "knife");
	assert_int_equal(sim_cut_script(scene, &text, &bytes, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "cut.tool");
	assert_null(text);
	scene->cut.present = 0;
	assert_int_equal(sim_cut_script(scene, &text, &bytes, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "cut");
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_scene_has_a_script),
		cmocka_unit_test(the_cut_is_drawn_as_described),
		cmocka_unit_test(a_scene_without_cut_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
