// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the program as users do, on the real core, and checks exit codes and output. The first
// argument is the program.
#include "program_run.h"

#include <math.h>

static void exit_codes_are_as_documented(void **state)
{
	(void)state;
	char output[4096];
	fixture_write(fixture_path("bad.jsonl"), "{\"command\":\"nope\"}\n");
	// At the tick of the second command, the first command has already removed the tool.
	fixture_write(fixture_path("late.jsonl"),
	              "{\"command\":\"tool.remove\",\"tool\":\"needle\",\"tick\":3}\n"
	              "{\"command\":\"tool.energize\",\"tool\":\"needle\",\"tick\":3,"
	              "\"energized\":true}\n");
	char script[512], late[512], csv[512];
	snprintf(script, sizeof script, "--scene patterns --script %s", fixture_path("bad.jsonl"));
	snprintf(late, sizeof late, "--scene patterns --script %s", fixture_path("late.jsonl"));
	snprintf(csv, sizeof csv, "--scene patterns --seconds 0.1 --csv /nowhere/at/all.csv");
	const struct {
		const char *arguments;
		int code;
	} cases[] = {
		{"--help", 0},
		{"--scene patterns --seconds 0.1", 0},
		{csv, 1},
		{"", 2},
		{"--scene patterns --threads 99", 2},
		{"--scene patterns --no-such-option", 2},
		{"--scene no-such-scene", 3},
		{script, 3},
		{late, 4},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		int code = run_program(cases[i].arguments, output, sizeof output);
		if (code != cases[i].code)
			fail_msg("%s: exit code %d, not %d", cases[i].arguments, code, cases[i].code);
	}
}

// If the core refuses a scene, the message names the scene's file, not the script.
static void a_bad_scene_is_told_with_its_file(void **state)
{
	(void)state;
	char output[4096], arguments[600];
	fixture_write(
		fixture_path("bad.json"),
		"{\"name\":\"bad\",\"meshes\":[{\"name\":\"m\",\"source\":\"sheet\",\"size_m\":[0.06,0.04],"
		"\"cells\":[4,4]}],\"layers\":[{\"name\":\"a\",\"kind\":\"fascia\",\"mesh\":\"none\"}],"
		"\"tools\":[{\"name\":\"hook\",\"shape\":\"hook\"}],"
		"\"cut\":{\"tool\":\"hook\",\"from_m\":[0,0,0],\"to_m\":[0.01,0,0]}}");
	snprintf(arguments, sizeof arguments, "--scene %s --cut --json", fixture_path("bad.json"));
	assert_int_equal(run_program(arguments, output, sizeof output), 3);
	assert_non_null(strstr(output, "bad.json\",\"path\":\"layers[0].mesh\""));
}

// Returns the index of the column with this name, or -1.
static int column_of(const char *head, const char *name)
{
	const char *place = strstr(head, name);
	int column = 0;
	if (!place || place > strchr(head, '\n'))
		return -1;
	for (const char *c = head; c < place; c++)
		column += *c == ',';
	return column;
}

static double cell_of(const char *line, int column)
{
	assert_true(column >= 0);
	for (; column > 0; column--)
		line = strchr(line, ',') + 1;
	return atof(line);
}

// Runs 5 s of the scene's cut without output files and with them: the hash must be the same. The
// ticks are written to ticks.csv.
static void expect_files_change_nothing(const char *scene)
{
	char arguments[512], plain[17], with_files[17];
	snprintf(arguments, sizeof arguments, "--scene %s --cut --seconds 5 --json", scene);
	read_hash(arguments, plain);
	snprintf(arguments, sizeof arguments,
	         "--scene %s --cut --seconds 5 --json --csv %s --vtu %s --vtu-every 50", scene,
	         fixture_path("ticks.csv"), fixture_path("states"));
	read_hash(arguments, with_files);
	assert_string_equal(with_files, plain);
}

// In these scenes with sheets and fat, each step starts with the rotations of the step before.
// Files must not change these rotations.
static void files_change_nothing(void **state)
{
	(void)state;
	expect_files_change_nothing("layers");
}

// The scene has a hot hook that is pulled through taut fascia, which moves and has energy.
static void ticks_tell_energies_and_times(void **state)
{
	(void)state;
	size_t bytes;
	expect_files_change_nothing("fascia");
	char *text = fixture_read(fixture_path("ticks.csv"), &bytes);
	const char *last = strstr(text, "\n300,");
	assert_non_null(last);
	assert_true(cell_of(last, column_of(text, "kinetic_j")) > 0);
	assert_true(cell_of(last, column_of(text, "elastic_j")) > 0);
	assert_true(cell_of(last, column_of(text, "gravitational_j")) != 0);
	assert_true(cell_of(last, column_of(text, "stage_local_s")) > 0);
	assert_true(cell_of(last, column_of(text, "stage_local_s")) < 1);
	assert_true(cell_of(last, column_of(text, "hook_temperature_c")) > 100);
	assert_true(cell_of(last, column_of(text, "hook_energy_j")) > 0);
	free(text);
}

// A needle that cuts by electric power: the ledger accounts for all energy, and power stays within
// 30 W.
static void ticks_tell_the_ledger(void **state)
{
	(void)state;
	size_t bytes;
	expect_files_change_nothing("fascia-power");
	char *text = fixture_read(fixture_path("ticks.csv"), &bytes);
	const char *last = strstr(text, "\n120,");
	assert_non_null(last);
	double in =
		cell_of(last, column_of(text, "delivered_j")) + cell_of(last, column_of(text, "blade_j"));
	double out = 0;
	for (const char *const *column = (const char *const[]){"stored_j", "boiled_j", "perfused_j",
	                                                       "ambient_j", "shed_j", NULL};
	     *column; column++)
		out += cell_of(last, column_of(text, *column));
	assert_true(in > 1);
	assert_true(fabs(in - out) < 1e-6 * in);
	// largest values of all ticks; in some ticks no tissue is within reach
	double watts = 0, ohm = 0;
	double vapour_kg = 0;
	for (const char *line = strchr(text, '\n'); line && line[1]; line = strchr(line + 1, '\n')) {
		watts = fmax(watts, cell_of(line, column_of(text, "needle_delivered_w")));
		ohm = fmax(ohm, cell_of(line, column_of(text, "needle_load_ohm")));
		if (line <= last)
			vapour_kg += cell_of(line, column_of(text, "vapour_kg_s")) / 60;
	}
	// Expected from the enthalpy of evaporation and from heating water from 37 to 100 degC.
	double boiled_j = cell_of(last, column_of(text, "boiled_j"));
	assert_true(boiled_j > 0 &&
	            fabs(vapour_kg * (2.257e6 + 4186 * 63) - boiled_j) < 1e-6 * boiled_j);
	assert_true(watts > 10 && watts <= 30);
	assert_true(ohm > 100);
	free(text);
}

// The scene's own cut divides the artery, which then bleeds.
static void ticks_report_vessels(void **state)
{
	(void)state;
	char arguments[512], output[4096];
	size_t bytes;
	snprintf(arguments, sizeof arguments, "--scene pedicle --cut --csv %s",
	         fixture_path("vessels.csv"));
	assert_int_equal(run_program(arguments, output, sizeof output), 0);
	char *text = fixture_read(fixture_path("vessels.csv"), &bytes);
	double shed = 0, parted = 0;
	for (const char *line = strchr(text, '\n'); line && line[1]; line = strchr(line + 1, '\n')) {
		double now = cell_of(line, column_of(text, "artery_shed_m3"));
		assert_true(now >= shed);
		shed = now;
		parted = cell_of(line, column_of(text, "artery_parted"));
		assert_true(parted == 1 || cell_of(line, column_of(text, "artery_sealed")) == 0);
	}
	assert_true(parted == 1 && shed > 1e-7);
	free(text);
}

// A cold hook presses on taut fascia, which pushes it up.
static void ticks_tell_forces(void **state)
{
	(void)state;
	char arguments[512], output[4096];
	size_t bytes;
	fixture_write(fixture_path("press.jsonl"),
	              "{\"command\":\"tool.move\",\"tick\":1,\"tool\":\"hook\","
	              "\"position_m\":[0,0,-0.003],\"rotation\":[1,0,0,0]}\n");
	snprintf(arguments, sizeof arguments, "--scene fascia --seconds 1 --script %s --csv %s",
	         fixture_path("press.jsonl"), fixture_path("pressed.csv"));
	assert_int_equal(run_program(arguments, output, sizeof output), 0);
	char *text = fixture_read(fixture_path("pressed.csv"), &bytes);
	const char *last = strstr(text, "\n60,");
	assert_non_null(last);
	double up = cell_of(last, column_of(text, "hook_force_z_n"));
	assert_true(up > 0);
	double most = cell_of(last, column_of(text, "tool_force_max_n"));
	assert_true(most >= up);
	double filtered = cell_of(last, column_of(text, "hook_filtered_force_z_n"));
	assert_true(filtered > 0 && filtered <= most);
	free(text);
}

// All columns but the last, the stages' times, have the same bytes in each run and with any number
// of threads.
static void ticks_are_the_same_but_for_their_times(void **state)
{
	(void)state;
	char *text[2], arguments[512], hash[17];
	size_t bytes;
	for (int i = 0; i < 2; i++) {
		snprintf(arguments, sizeof arguments,
		         "--scene fascia --cut --seconds 3 --json --threads %d --csv %s", i + 1,
		         fixture_path("same.csv"));
		read_hash(arguments, hash);
		text[i] = fixture_read(fixture_path("same.csv"), &bytes);
	}
	int columns = column_of(text[0], "stage_commands_s"), lines = 0;
	const char *line[2] = {text[0], text[1]};
	while (line[0] && *line[0] && line[1]) {
		size_t length = 0;
		for (int comma = 0; comma < columns; length++)
			comma += line[0][length] == ',';
		assert_memory_equal(line[0], line[1], length);
		lines++;
		for (int i = 0; i < 2; i++) {
			line[i] = strchr(line[i], '\n');
			line[i] = line[i] ? line[i] + 1 : NULL;
		}
	}
	assert_int_equal(lines, 181);
	assert_null(strstr(strstr(text[0], ",stage_"), ",hook_"));
	free(text[0]);
	free(text[1]);
}

static void the_cut_parts_tissue(void **state)
{
	(void)state;
	char output[8192];
	assert_int_equal(run_program("--scene fascia --cut --seconds 8 --json", output, sizeof output),
	                 0);
	const char *place = strstr(output, "\"elements_removed\":");
	assert_non_null(place);
	assert_true(atoi(place + strlen("\"elements_removed\":")) > 0);
}

static void print_cut_prints_commands_of_the_scenes_tool(void **state)
{
	(void)state;
	static char output[1 << 18];
	assert_int_equal(run_program("--scene layers --print-cut", output, sizeof output), 0);
	int lines = 0;
	for (char *line = strtok(output, "\n"); line; line = strtok(NULL, "\n"), lines++)
		assert_non_null(strstr(line, "\"tool\":\"hook\""));
	assert_true(lines > 100);
}

int main(int argument_count, char **arguments)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(exit_codes_are_as_documented),
		cmocka_unit_test(a_bad_scene_is_told_with_its_file),
		cmocka_unit_test(print_cut_prints_commands_of_the_scenes_tool),
		cmocka_unit_test(files_change_nothing),
		cmocka_unit_test(ticks_tell_energies_and_times),
		cmocka_unit_test(ticks_tell_the_ledger),
		cmocka_unit_test(ticks_report_vessels),
		cmocka_unit_test(ticks_tell_forces),
		cmocka_unit_test(ticks_are_the_same_but_for_their_times),
		cmocka_unit_test(the_cut_parts_tissue),
	};
	if (argument_count < 2) {
		fputs("the program to test is the first argument\n", stderr);
		return 1;
	}
	program = arguments[1];
	return cmocka_run_group_tests(tests, NULL, fixture_remove);
}
