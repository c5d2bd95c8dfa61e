// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/command_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <string.h>

#include <cmocka.h>

static void read_ok(const char *text, cau_command *command)
{
	cau_error error = {0};
	if (cau_command_from_json(text, strlen(text), command, &error))
		fail_msg("%s: %s: %s", text, error.path, error.reason);
}

// At least one command of each kind.
static const char *const commands[] = {
	"{\"command\":\"tool.add\",\"name\":\"hook\",\"shape\":\"hook\",\"hot_radius_m\":0.002,"
	"\"position_m\":[0,0,0.1],\"rotation\":[0,1,0,0]}",
	"{\"command\":\"tool.remove\",\"tool\":\"hook\"}",
	"{\"command\":\"tool.configure\",\"tool\":\"hook\",\"shape\":\"shears\",\"temperature_c\":90}",
	"{\"tick\":60,\"sequence\":7,\"command\":\"tool.move\",\"tool\":\"hook\","
	"\"position_m\":[0.1,-0.2,0.3],\"rotation\":[0.6,0,0.8,0],\"jaw\":0.5}",
	"{\"command\":\"tool.energize\",\"tool\":\"hook\",\"energized\":true}",
	"{\"command\":\"tool.grasp\",\"tool\":\"grip\"}",
	"{\"command\":\"tool.release\",\"tool\":\"grip\"}",
	"{\"command\":\"pin\",\"selection\":{\"kind\":\"rim\",\"layer\":\"fascia\"}}",
	"{\"command\":\"unpin\",\"selection\":{\"kind\":\"sphere\",\"center_m\":[0,0,0],"
	"\"radius_m\":0.01}}",
	"{\"command\":\"material.set\",\"layer\":\"fat\",\"kind\":\"fat\",\"region\":2,"
	"\"model\":\"corotated\",\"poisson_ratio\":0.2}",
	"{\"command\":\"material.set\",\"layer\":\"skin\",\"kind\":\"membrane\",\"thickness_m\":0.001}",
	"{\"command\":\"material.set\",\"layer\":\"ties\",\"kind\":\"links\",\"area_m2\":1e-7}",
	"{\"command\":\"gravity.set\",\"gravity_m_s2\":[0,-9.81,0]}",
	"{\"command\":\"force.set\",\"selection\":{\"kind\":\"nearest\",\"center_m\":[0,0,0]},"
	"\"force_n\":[0,0,-1]}",
	"{\"command\":\"tool.hold\",\"tool\":\"hook\"}",
	"{\"command\":\"tool.energize\",\"tool\":\"hook\",\"energized\":true,\"ticks\":180}",
};

static void every_command_comes_back(void **state)
{
	(void)state;
	int seen[CAU_COMMAND_COUNT] = {0};
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		char text[4096];
		size_t bytes;
		cau_command first, second;
		cau_error error = {0};
		memset(&first, 0xAA, sizeof first);
		memset(&second, 0x55, sizeof second);
		read_ok(commands[i], &first);
		assert_int_equal(cau_command_to_json(&first, text, sizeof text, &bytes, &error), CAU_OK);
		assert_int_equal(bytes, strlen(text));
		assert_null(strchr(text, '\n'));
		read_ok(text, &second);
		assert_memory_equal(&first, &second, sizeof first);
		seen[first.kind]++;
	}
	for (int kind = 0; kind < CAU_COMMAND_COUNT; kind++)
		assert_true(seen[kind] > 0);
}

static void members_land_where_they_belong(void **state)
{
	(void)state;
	cau_command c;
	read_ok(commands[3], &c);
	assert_int_equal(c.kind, CAU_COMMAND_TOOL_MOVE);
	assert_true(c.tick == 60 && c.sequence == 7 && c.as.move.jaw == 0.5);
	assert_string_equal(c.tool, "hook");
	assert_true(c.as.move.pose.position_m[1] == -0.2 && c.as.move.pose.rotation[2] == 0.8);
	read_ok(commands[4], &c);
	assert_int_equal(c.as.energized, 1);
	read_ok(commands[9], &c);
	assert_int_equal(c.as.material.kind, CAU_LAYER_FAT);
	assert_int_equal(c.as.material.fat.region, 2);
	assert_int_equal(c.as.material.fat.model, CAU_MODEL_COROTATED);
	assert_true(c.as.material.fat.heat.ignition_c == 76.0);
	read_ok(commands[10], &c);
	assert_true(c.as.material.sheet.heat.ignition_c == 96.4);
	assert_string_equal(c.as.material.layer, "skin");
	read_ok(commands[13], &c);
	assert_true(c.as.force.force_n[2] == -1.0);
	assert_int_equal(c.as.force.selection.kind, CAU_SELECT_NEAREST);
	read_ok(commands[15], &c);
	assert_int_equal(c.as.energized, 1);
	assert_int_equal(c.as.ticks, 180);
}

typedef struct refusal {
	const char *text, *path, *reason;
} refusal;

static const refusal refused[] = {
	{"{}", "command", "missing: a string is needed"},
	{"3", "", "an object is needed, not 3"},
	{"{\"command\":\"tool.mvoe\"}", "command",
     "\"tool.mvoe\" is none of tool.add, tool.remove, tool.configure, tool.move, tool.energize, "
     "tool.grasp, tool.release, pin, unpin, material.set, gravity.set, force.set, tool.hold; did "
     "you mean \"tool.move\"?"},
	{"{\"command\":\"tool.energize\",\"tool\":\"a\",\"energized\":true,\"ticks\":-1}", "ticks",
     "-1 is outside 0 to 2147483647"},
	{"{\"command\":\"tool.move\",\"position_m\":[0,0,0]}", "tool", "missing: a string is needed"},
	{"{\"command\":\"tool.move\",\"tool\":\"a\"}", "position_m",
     "missing: an array of 3 is needed"},
	{"{\"command\":\"tool.move\",\"tool\":\"a\",\"position_m\":[0,0,0]}", "rotation",
     "missing: an array of 4 is needed"},
	{"{\"command\":\"tool.move\",\"tool\":\"a\",\"position_m\":[0,0,0],\"rotation\":[1,0,0,0.1]}",
     "rotation", "a quaternion of length 1.00499, not within 0.001 of 1"},
	{"{\"command\":\"tool.move\",\"tool\":\"a\",\"position_m\":[0,101,0],\"rotation\":[1,0,0,0]}",
     "position_m[1]", "101 is outside -100 to 100 m"},
	{"{\"command\":\"tool.move\",\"tool\":\"a\",\"position_m\":[0,0,0],\"rotation\":[1,0,0,0],"
     "\"jaw\":1.5}",
     "jaw", "1.5 is outside 0 to 1"},
	{"{\"command\":\"tool.energize\",\"tool\":\"a\",\"energized\":1}", "energized",
     "true or false is needed, not 1"},
	{"{\"command\":\"tool.grasp\",\"tool\":\"a\",\"energized\":true}", "energized", "unknown"},
	{"{\"command\":\"gravity.set\",\"tool\":\"a\",\"gravity_m_s2\":[0,0,0]}", "tool",
     "a command of kind \"gravity.set\" has no such member"},
	{"{\"command\":\"tool.configure\",\"tool\":\"a\",\"shape\":\"hook\",\"position_m\":[0,0,0]}",
     "position_m", "unknown"},
	{"{\"command\":\"pin\"}", "selection", "missing: an object is needed"},
	{"{\"command\":\"pin\",\"selection\":{\"kind\":\"box\",\"least_m\":[0,0,0]}}",
     "selection.most_m", "missing: an array of 3 is needed"},
	{"{\"command\":\"material.set\",\"layer\":\"a\"}", "kind", "missing: a string is needed"},
	{"{\"command\":\"material.set\",\"layer\":\"a\",\"kind\":\"links\",\"region\":1}", "region",
     "unknown"},
	{"{\"command\":\"pin\",\"tick\":-1}", "tick", "-1 is outside 0 to 9007199254740991"},
	{"{\"command\":\"tool.grasp\",\"tool\":\"a\",\"sequenec\":1}", "sequenec",
     "unknown: did you mean \"sequence\"?"},
};

static void refuses_and_says_where(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
		const refusal *r = &refused[i];
		cau_command command;
		cau_error error = {0};
		cau_status status = cau_command_from_json(r->text, strlen(r->text), &command, &error);
		if (status != CAU_BAD_VALUE || strcmp(error.path, r->path) != 0 ||
		    strcmp(error.reason, r->reason) != 0)
			fail_msg("%s: status %d, %s: %s", r->text, (int)status, error.path, error.reason);
	}
}

static void refuses_syntax_and_size(void **state)
{
	(void)state;
	static char large[CAU_COMMAND_JSON_MAX_BYTES + 1];
	cau_command command;
	cau_error error;
	memset(large, ' ', sizeof large);
	assert_int_equal(cau_command_from_json(large, sizeof large, &command, &error), CAU_LIMIT);
	assert_int_equal(cau_command_from_json("{", 1, &command, &error), CAU_BAD_SYNTAX);
}

static void writing_refuses_kinds_that_do_not_exist(void **state)
{
	(void)state;
	char text[1024];
	cau_command command;
	cau_error error;
	read_ok(commands[1], &command);
	assert_int_equal(cau_command_to_json(&command, text, 8, NULL, &error), CAU_LIMIT);
	command.kind = CAU_COMMAND_COUNT;
	assert_int_equal(cau_command_to_json(&command, text, sizeof text, NULL, &error), CAU_BAD_VALUE);
	command.kind = -1;
	assert_int_equal(cau_command_to_json(&command, text, sizeof text, NULL, &error), CAU_BAD_VALUE);
	read_ok(commands[9], &command);
	command.as.material.kind = 9;
	assert_int_equal(cau_command_to_json(&command, text, sizeof text, NULL, &error), CAU_BAD_VALUE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_command_comes_back),
		cmocka_unit_test(members_land_where_they_belong),
		cmocka_unit_test(refuses_and_says_where),
		cmocka_unit_test(refuses_syntax_and_size),
		cmocka_unit_test(writing_refuses_kinds_that_do_not_exist),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
