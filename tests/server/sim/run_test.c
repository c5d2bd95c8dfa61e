// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/run.h"

#include "sim_fixture.h"

#define MOVE(tick)                                                                                 \
	"{\"command\":\"tool.move\",\"tick\":" #tick ",\"tool\":\"hook\",\"position_m\":[0,0,0],"      \
	"\"rotation\":[1,0,0,0]}\n"
#define ENERGY(tick, on)                                                                           \
	"{\"command\":\"tool.energize\",\"tick\":" #tick ",\"tool\":\"hook\",\"energized\":" #on "}\n"

static const sim_options plain = {
	.threads = 1, .unit_m = 1.0, .seconds = -1.0, .vtu_every = 10, .snapshot_at = -1};

static cau_status run_script(const sim_options *options, const char *script, FILE *notes,
                             sim_result *result, bool *in_input, cau_error *error)
{
	cau_scene_def *scene = fixture_scene();
	memset(error, 0, sizeof *error);
	cau_status status =
		sim_run(options, scene, "s.jsonl", script, strlen(script), notes, result, in_input, error);
	free(scene);
	return status;
}

static void a_script_runs_to_its_end_and_a_second_more(void **state)
{
	(void)state;
	sim_result result;
	cau_error error;
	bool in_input;
	assert_int_equal(run_script(&plain, MOVE(5) ENERGY(30, true) ENERGY(40, false), NULL, &result,
	                            &in_input, &error),
	                 CAU_OK);
	assert_int_equal(result.ticks, 100);
	assert_int_equal(result.commands, 3);
	// Energy goes on before the step to tick 31.
	assert_true(result.energized_s > 30.5 / 60.0 && result.energized_s < 31.5 / 60.0);
	assert_true(result.hash != 0);
	assert_false(in_input);
}

static void seconds_cut_a_script_short(void **state)
{
	(void)state;
	sim_options options = plain;
	sim_result result;
	cau_error error;
	bool in_input;
	options.seconds = 0.5;
	assert_int_equal(run_script(&options, MOVE(5) MOVE(300), NULL, &result, &in_input, &error),
	                 CAU_OK);
	assert_int_equal(result.ticks, 30);
	assert_int_equal(result.commands, 1);
}

// The hash depends on the commands, but not on a change of sessions, whenever it comes.
static void a_snapshot_changes_nothing(void **state)
{
	(void)state;
	static const char script[] = MOVE(5) ENERGY(10, true) MOVE(20) ENERGY(40, false);
	sim_result unbroken, result;
	cau_error error;
	bool in_input;
	assert_int_equal(run_script(&plain, script, NULL, &unbroken, &in_input, &error), CAU_OK);
	assert_int_equal(unbroken.snapshot_bytes, 0);
	for (int tick = 0; tick < 100; tick += 5) {
		sim_options options = plain;
		options.snapshot_at = tick;
		assert_int_equal(run_script(&options, script, NULL, &result, &in_input, &error), CAU_OK);
		assert_true(result.snapshot_bytes > 0 && result.snapshot_exact);
		assert_true(result.hash == unbroken.hash);
	}
	assert_int_equal(run_script(&plain, MOVE(5) MOVE(40), NULL, &result, &in_input, &error),
	                 CAU_OK);
	assert_true(result.hash != unbroken.hash);
}

static void mistakes_in_a_script_come_before_the_run(void **state)
{
	(void)state;
	sim_result result;
	cau_error error;
	bool in_input;
	assert_int_equal(
		run_script(&plain, MOVE(5) "{\"command\":\"nope\"}\n", NULL, &result, &in_input, &error),
		CAU_BAD_VALUE);
	assert_true(in_input && result.ticks == 0);
	assert_string_equal(error.file, "s.jsonl");
	assert_non_null(strstr(error.reason, "script line 2"));
}

static void a_refused_command_names_its_line(void **state)
{
	(void)state;
	sim_result result;
	cau_error error;
	bool in_input;
	assert_int_equal(run_script(&plain,
	                            MOVE(5) "\n{\"command\":\"tool.grasp\",\"tick\":9,"
	                                    "\"tool\":\"other\"}\n",
	                            NULL, &result, &in_input, &error),
	                 CAU_NOT_FOUND);
	assert_true(in_input);
	assert_int_equal(result.ticks, 9);
	assert_non_null(strstr(error.reason, "script line 3"));
}

// The double faults at the tick after a force of 1,000 N.
static void a_fault_ends_the_run_and_is_told(void **state)
{
	(void)state;
	sim_result result;
	cau_error error;
	bool in_input;
	assert_int_equal(run_script(&plain,
	                            "{\"command\":\"force.set\",\"tick\":20,\"selection\":"
	                            "{\"kind\":\"rim\"},\"force_n\":[1000,0,0]}\n",
	                            NULL, &result, &in_input, &error),
	                 CAU_NUMERICAL);
	assert_false(in_input);
	assert_true(result.ticks >= 20 && result.ticks < 80);
}

static void statistics_have_a_line_a_tick(void **state)
{
	(void)state;
	sim_options options = plain;
	sim_result result;
	cau_error error;
	bool in_input;
	size_t bytes;
	options.csv = fixture_path("run.csv");
	options.seconds = 0.5;
	assert_int_equal(run_script(&options, MOVE(5), NULL, &result, &in_input, &error), CAU_OK);
	char *text = fixture_read(options.csv, &bytes);
	int lines = 0, commas = 0;
	for (const char *c = text; *c; c++) {
		lines += *c == '\n';
		commas += *c == ',';
	}
	assert_int_equal(lines, 31);
	assert_int_equal(commas % lines, 0); // each line has the same number of cells
	assert_memory_equal(text, "tick,time_s,", 12);
	assert_non_null(strstr(text, "\n30,0.5,"));
	for (const char *const *column =
	         (const char *const[]){",kinetic_j,", ",elastic_j,", ",stage_local_s,",
	                               ",hook_force_z_n,", ",hook_temperature_c,", NULL};
	     *column; column++)
		assert_non_null(strstr(text, *column));
	free(text);
	options.csv = "/nowhere/at/all.csv";
	assert_int_equal(run_script(&options, "", NULL, &result, &in_input, &error), CAU_IO);
	assert_false(in_input);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_script_runs_to_its_end_and_a_second_more),
		cmocka_unit_test(seconds_cut_a_script_short),
		cmocka_unit_test(a_snapshot_changes_nothing),
		cmocka_unit_test(mistakes_in_a_script_come_before_the_run),
		cmocka_unit_test(a_refused_command_names_its_line),
		cmocka_unit_test(a_fault_ends_the_run_and_is_told),
		cmocka_unit_test(statistics_have_a_line_a_tick),
	};
	return cmocka_run_group_tests(tests, NULL, fixture_remove);
}
