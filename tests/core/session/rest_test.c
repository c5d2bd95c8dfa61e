// SPDX-License-Identifier: GPL-3.0-or-later
// Rest: tissue that has stopped keeps its bits, and every run rests at the same tick. Resting
// tissue is at the position at which it would have stopped. Everything that could move the tissue
// wakes it.
#include "core/session/stage.h"
#include "session/session_internal.h"

#include "base/hash.h"

enum { LONGEST = 3000 };
static const double gravity_z = -9.81;

static bool rests(const cau_session *session)
{
	return stage_frame(session).statistics.resting;
}

// Steps until the tissue rests. Returns the number of ticks.
static int32_t step_to_rest(cau_session *session)
{
	int32_t ticks = 0;
	for (; !rests(session); ticks++) {
		if (ticks == LONGEST)
			fail_msg("no rest after %d ticks", ticks);
		stage_step(session, 1);
	}
	return ticks;
}

// Returns a scene: a taut sheet, pinned at its rim, with a hook and jaws above it, out of reach.
static cau_scene_def *make_sheet(void)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	stage_add_taut_sheet(scene);
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, 0, 0, 0.03);
	stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.01, 0, 0.04);
	return scene;
}

// Returns a scene: a block of fat, pinned at its top.
static cau_scene_def *make_hanging_block(int precision)
{
	const double size[3] = {0.03, 0.02, 0.02}, least[3] = {-1, -1, -1e-4}, most[3] = {1, 1, 1};
	const int32_t cells[3] = {5, 4, 4};
	cau_scene_def *scene = stage_scene(precision);
	cau_default_gravity(scene->gravity_m_s2);
	stage_add_slab(scene, "fat", size, cells);
	stage_pin_box(scene, least, most);
	return scene;
}

// Wakes the tissue without any change.
static void keep_awake(cau_session *session)
{
	int32_t vertex = 0;
	while (!session->vertices.pinned[vertex])
		vertex++;
	double at[3]; // a support that is led to its present position
	memcpy(at, session->vertices.position + 3 * (size_t)vertex, sizeof at);
	assert_int_equal(cau_session_drive(session, 1, &vertex, at, NULL), CAU_OK);
}

static void every_bit_stays(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	cau_session *session = stage_open(scene, 1);
	size_t bytes = 3 * (size_t)stage_info(session).vertex_count * sizeof(double);
	assert_true(step_to_rest(session) >= 30); // half a second
	double *held = malloc(bytes);
	memcpy(held, stage_frame(session).position, bytes);
	uint64_t tick = stage_frame(session).tick;
	for (int k = 1; k <= 1000; k++) {
		stage_step(session, 1);
		cau_frame frame = stage_frame(session);
		assert_true(frame.statistics.resting && frame.tick == tick + (uint64_t)k);
		assert_int_equal(frame.moved_count, 0);
		assert_int_equal(frame.mask_changed_count, 0);
		assert_int_equal(frame.statistics.iterations, 0);
		assert_memory_equal(frame.position, held, bytes);
		for (size_t i = 0; i < bytes / sizeof(double); i++)
			assert_true(frame.velocity[i] == 0);
	}
	free(held);
	cau_session_destroy(session);
	free(scene);
}

// Resting tissue is within a few micrometres of its position after a minute awake.
static void loaded_tissue_rests_where_it_belongs(void **state)
{
	(void)state;
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		cau_scene_def *scene = make_hanging_block(precision);
		cau_session *session = stage_open(scene, 1), *awake = stage_open(scene, 1);
		int32_t ticks = step_to_rest(session);
		for (int32_t k = 0; k < ticks + 3600; k++) {
			keep_awake(awake);
			stage_step(awake, 1);
			assert_false(rests(awake));
		}
		cau_frame frame = stage_frame(session);
		double sag = stage_farthest(&frame, stage_info(session).rest_position,
		                            stage_info(session).vertex_count);
		double off =
			stage_farthest(&frame, stage_frame(awake).position, stage_info(session).vertex_count);
		print_message("rest after %d ticks, %.3g um off a sag of %.3g um\n", ticks, 1e6 * off,
		              1e6 * sag);
		assert_true(sag > 100e-6);
		assert_true(off < 5e-6);
		cau_session_destroy(session);
		cau_session_destroy(awake);
		free(scene);
	}
}

// Pressed tissue rests under the tool, and the tool continues to feel it.
static void a_tool_that_presses_feels_it_at_rest(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	cau_session *session = stage_open(scene, 1);
	stage_move(session, "hook", 0, 0, 0.001);
	stage_step(session, 60);
	step_to_rest(session);
	double force = stage_tool(session, "hook")->raw_force_n[2];
	double shown = stage_tool(session, "hook")->force_n[2];
	assert_true(fabs(force) > 1e-3 && fabs(shown - force) < 1e-3 * fabs(force));
	stage_step(session, 100);
	assert_true(rests(session));
	assert_true(stage_tool(session, "hook")->raw_force_n[2] == force);
	assert_true(stage_tool(session, "hook")->force_n[2] == shown);
	cau_session_destroy(session);
	free(scene);
}

// ---- causes that wake tissue
static void by_gravity(cau_session *session)
{
	stage_gravity(session, 3, 0, gravity_z);
}

static void by_force(cau_session *session)
{
	stage_force(session, stage_everything(), 0, 0, 1e-5);
}

static void by_move(cau_session *session)
{
	stage_move(session, "hook", 0.001, 0, 0.03);
}

static void by_jaw(cau_session *session)
{
	cau_command command = stage_command(CAU_COMMAND_TOOL_MOVE);
	strcpy(command.tool, "jaws");
	command.as.move.pose = stage_tool(session, "jaws")->pose;
	command.as.move.jaw = 0.5;
	stage_submit(session, &command);
}

static void by_energy(cau_session *session)
{
	stage_energize(session, "hook", 1);
}

static void by_grasp(cau_session *session)
{
	stage_grasp(session, "jaws");
}

static void by_release(cau_session *session) // the jaws are closed
{
	session->tool[cau_session_find_tool(session, "jaws")].state.grasping = true;
	stage_release(session, "jaws");
}

static void by_pin(cau_session *session)
{
	const double least[3] = {-0.01, -0.01, -1}, most[3] = {0.01, 0.01, 1};
	cau_command command = stage_command(CAU_COMMAND_PIN);
	command.as.selection = stage_box(least, most);
	stage_submit(session, &command);
}

static void by_material(cau_session *session)
{
	cau_command command = stage_command(CAU_COMMAND_SET_MATERIAL);
	command.as.material.kind = CAU_LAYER_FASCIA;
	cau_scene_def *scene = make_sheet();
	command.as.material.sheet = scene->layers[0].sheet[0];
	command.as.material.sheet.target[0] = 0.5;
	stage_submit(session, &command);
	free(scene);
}

static void by_removal(cau_session *session)
{
	cau_command command = stage_command(CAU_COMMAND_TOOL_REMOVE);
	stage_submit(session, &command);
}

static void by_tool(cau_session *session)
{
	cau_command command = stage_command(CAU_COMMAND_TOOL_ADD);
	stage_submit(session, &command);
}

static void by_support(cau_session *session)
{
	int32_t vertex = 0; // a vertex of the rim
	const double at[3] = {-0.031, -0.025, 0};
	assert_int_equal(cau_session_drive(session, 1, &vertex, at, NULL), CAU_OK);
}

static const struct cause {
	const char *name;
	void (*act)(cau_session *session);
	bool moves; // the cause moves tissue at once
} causes[] = {
	{"gravity", by_gravity, true},   {"force", by_force, true},
	{"tool move", by_move, false},   {"jaw", by_jaw, false},
	{"energy", by_energy, false},    {"grasp", by_grasp, false},
	{"release", by_release, false},  {"pin", by_pin, false},
	{"material", by_material, true}, {"tool removed", by_removal, false},
	{"tool added", by_tool, false},  {"support led", by_support, true},
};

static void each_cause_wakes(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	cau_session *session = stage_open(scene, 1);
	step_to_rest(session);
	stage_bytes shot = stage_snapshot(session);
	for (size_t i = 0; i < sizeof causes / sizeof *causes; i++) {
		assert_int_equal(cau_session_restore(session, shot.bytes, shot.count, NULL, NULL), CAU_OK);
		stage_step(session, 3);
		assert_true(rests(session));
		causes[i].act(session);
		assert_true(rests(session)); // tissue rests until the next tick
		stage_step(session, 1);
		if (rests(session))
			fail_msg("%s does not wake", causes[i].name);
		cau_frame frame = stage_frame(session);
		if (causes[i].moves && !frame.moved_count)
			fail_msg("nothing moves after %s", causes[i].name);
		assert_true(frame.statistics.iterations > 0);
		stage_step(session, 3);
		assert_false(rests(session)); // tissue stays awake for at least half a second
	}
	free(shot.bytes);
	cau_session_destroy(session);
	free(scene);
}

// A command for a later tick wakes the tissue only at that tick.
static void a_command_wakes_at_its_tick(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	cau_session *session = stage_open(scene, 1);
	step_to_rest(session);
	cau_command later = stage_command(CAU_COMMAND_SET_GRAVITY);
	later.as.gravity_m_s2[0] = 1;
	later.tick = stage_frame(session).tick + 5;
	stage_submit(session, &later);
	stage_step(session, 5);
	assert_true(rests(session));
	stage_step(session, 1);
	assert_false(rests(session));
	cau_session_destroy(session);
	free(scene);
}

// Drivers that hold still send the same pose at the rate of their screens.
static void a_move_to_where_it_stands_does_not_wake(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	cau_session *session = stage_open(scene, 1);
	step_to_rest(session);
	cau_command command = stage_command(CAU_COMMAND_TOOL_MOVE);
	command.as.move.pose = stage_tool(session, "hook")->pose;
	command.as.move.jaw = 1;
	for (uint64_t k = 1; k <= 50; k++) {
		command.sequence = k;
		stage_submit(session, &command);
		stage_step(session, 1);
		assert_true(rests(session));
		assert_true(stage_tool(session, "hook")->sequence == k);
	}
	cau_session_destroy(session);
	free(scene);
}

// ---- causes that keep tissue awake

// An energized tool keeps the tissue awake, then the tool's warm grid. At ambient the tissue rests.
static void heat_keeps_it_awake(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	cau_session *session = stage_open(scene, 1);
	stage_energize(session, "hook", 1);
	for (int k = 0; k < 120; k++) {
		stage_step(session, 1);
		assert_false(rests(session));
	}
	stage_energize(session, "hook", 0);
	for (int k = 0; k < LONGEST && !rests(session); k++) {
		stage_step(session, 1);
		if (rests(session))
			assert_true(cau_heat_grid_is_ambient(&session->tool[0].grid));
	}
	assert_true(rests(session));
	assert_true(stage_tool(session, "hook")->tip_temperature_c == scene->ambient_c);
	cau_session_destroy(session);
	free(scene);
}

// Cut tissue rests once nothing shrinks and the factor has removed all elements. The teeth of the
// cut hang by a corner and would oscillate for long.
static void a_cut_is_done_before_it_rests(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	scene->layers[0].sheet[0].heat.absorption_per_s = 8;
	scene->layers[0].sheet[0].shrink[0] = 0.3;
	scene->damping_per_s = 20;
	cau_session *session = stage_open(scene, 1);
	stage_move(session, "hook", 0, 0, 0.001);
	stage_energize(session, "hook", 1);
	stage_step(session, 60);
	assert_true(stage_frame(session).statistics.elements_removed > 0);
	stage_energize(session, "hook", 0);
	stage_move(session, "hook", 0, 0, 0.04);
	for (int k = 0; k < 2 * LONGEST && !rests(session); k++)
		stage_step(session, 1);
	assert_true(rests(session));
	assert_int_equal(session->shrink.active_count, 0);
	assert_int_equal(session->update.waiting_count, 0);
	assert_false(session->update.making);
	cau_session_destroy(session);
	free(scene);
}

// ---- determinism

enum { RUN = 160, WAKE_AT = 70 };

// Runs a tick. The tissue rests, is woken, and rests again.
static void run_tick(cau_session *session)
{
	uint64_t tick = stage_frame(session).tick;
	if (tick == WAKE_AT)
		stage_move(session, "hook", 0, 0, 0.001);
	stage_step(session, 1);
}

static void threads_and_restores_change_no_bit(void **state)
{
	(void)state;
	cau_scene_def *scene = make_sheet();
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 2);
	uint64_t hash[RUN + 1];
	stage_bytes shot[RUN + 1];
	int32_t rested = 0;
	for (int k = 0; k <= RUN; k++) {
		hash[k] = cau_session_hash(session);
		shot[k] = stage_snapshot(session);
		assert_true(cau_session_hash(other) == hash[k]);
		rested += rests(session);
		run_tick(session);
		run_tick(other);
	}
	assert_true(rested > 20 && rested < RUN - 60);
	for (int from = 0; from <= RUN; from += 7) {
		bool exact = false;
		assert_int_equal(
			cau_session_restore(other, shot[from].bytes, shot[from].count, &exact, NULL), CAU_OK);
		assert_true(exact);
		for (int k = from; k <= RUN; k++) {
			if (cau_session_hash(other) != hash[k])
				fail_msg("restored at tick %d, the state differs at tick %d", from, k);
			run_tick(other);
		}
	}
	for (int k = 0; k <= RUN; k++)
		free(shot[k].bytes);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_bit_stays),
		cmocka_unit_test(loaded_tissue_rests_where_it_belongs),
		cmocka_unit_test(a_tool_that_presses_feels_it_at_rest),
		cmocka_unit_test(each_cause_wakes),
		cmocka_unit_test(a_command_wakes_at_its_tick),
		cmocka_unit_test(a_move_to_where_it_stands_does_not_wake),
		cmocka_unit_test(heat_keeps_it_awake),
		cmocka_unit_test(a_cut_is_done_before_it_rests),
		cmocka_unit_test(threads_and_restores_change_no_bit),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
