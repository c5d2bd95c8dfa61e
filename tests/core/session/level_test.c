// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that state a level are idempotent. A repetition with a new sequence number, at any tick,
// changes no bit of the tissue.
#include "core/session/stage.h"

enum { TICKS = 16, MOST = 2 };

// The kinds of commands that state a level. The other kinds create or remove something, once.
static const bool levels[CAU_COMMAND_COUNT] = {
	[CAU_COMMAND_TOOL_CONFIGURE] = true, [CAU_COMMAND_TOOL_MOVE] = true,
	[CAU_COMMAND_TOOL_ENERGIZE] = true,  [CAU_COMMAND_TOOL_GRASP] = true,
	[CAU_COMMAND_TOOL_RELEASE] = true,   [CAU_COMMAND_PIN] = true,
	[CAU_COMMAND_UNPIN] = true,          [CAU_COMMAND_SET_MATERIAL] = true,
	[CAU_COMMAND_SET_GRAVITY] = true,    [CAU_COMMAND_SET_FORCE] = true,
};

static const bool once[CAU_COMMAND_COUNT] = {
	[CAU_COMMAND_TOOL_ADD] = true,
	[CAU_COMMAND_TOOL_REMOVE] = true,
	[CAU_COMMAND_TOOL_HOLD] = true, // holds the present pose, which may differ from the earlier one
};

// Returns a scene: a slab between the jaws of the tool `jaws`. In this case repeated grasps once
// held 7, 3 and 0 points.
static cau_scene_def *between_jaws(void)
{
	const double size[3] = {0.04, 0.04, 0.016};
	const int32_t cells[3] = {6, 6, 2};
	const double least[3] = {-1, -1, -0.0161}, most[3] = {1, 1, -0.0159};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_slab(scene, "fat", size, cells);
	stage_pin_box(scene, least, most);
	stage_add_tool(scene, "jaws", CAU_TOOL_BIPOLAR, 0, 0, -0.001);
	return scene;
}

static cau_command about(int kind)
{
	cau_command command = stage_command(kind);
	if (kind != CAU_COMMAND_TOOL_ADD)
		strcpy(command.tool, "jaws");
	return command;
}

// Returns a command of this kind that changes something; `variant` is 0 or 1.
static cau_command level_of(int kind, int variant)
{
	const double least[3] = {0.008, -1, -1}, most[3] = {1, 1, 1};
	cau_command command = about(kind);
	switch (kind) {
	case CAU_COMMAND_TOOL_CONFIGURE:
		command.as.definition.shape = CAU_TOOL_BIPOLAR;
		command.as.definition.temperature_c = variant ? 90 : 200;
		break;
	case CAU_COMMAND_TOOL_MOVE:
		command.as.move.pose.position_m[2] = variant ? 0.004 : -0.003;
		command.as.move.jaw = variant;
		break;
	case CAU_COMMAND_TOOL_ENERGIZE:
		command.as.energized = !variant;
		break;
	case CAU_COMMAND_PIN:
	case CAU_COMMAND_UNPIN:
		command.as.selection = stage_box(least, most);
		break;
	case CAU_COMMAND_SET_MATERIAL:
		strcpy(command.as.material.layer, "fat");
		command.as.material.kind = CAU_LAYER_FAT;
		command.as.material.fat.young_modulus_pa *= variant ? 2 : 0.5;
		break;
	case CAU_COMMAND_SET_GRAVITY:
		command.as.gravity_m_s2[0] = variant ? 2 : -2;
		break;
	case CAU_COMMAND_SET_FORCE:
		command.as.force.selection = stage_everything();
		command.as.force.force_n[2] = variant ? 1e-3 : -1e-3;
		break;
	default:
		break;
	}
	return command;
}

// The state in which the level is stated: as at the start, held by the jaws, or with energy on.
typedef enum before { AT_FIRST, HELD, ON, BEFORE_COUNT } before;

static cau_session *open_at(const cau_scene_def *scene, before what)
{
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 2);
	cau_command grasp = about(CAU_COMMAND_TOOL_GRASP), on = about(CAU_COMMAND_TOOL_ENERGIZE);
	on.as.energized = 1;
	if (what == HELD)
		stage_submit(session, &grasp);
	if (what == ON)
		stage_submit(session, &on);
	stage_step(session, 5);
	return session;
}

// Returns the hashes after each of TICKS ticks. The level is stated at the first tick, and again at
// the tick `again` (-1: never; -2: at every tick).
static void run(const cau_scene_def *scene, before what, cau_command level, int again,
                uint64_t hashes[TICKS])
{
	cau_session *session = open_at(scene, what);
	for (int tick = 0; tick < TICKS; tick++) {
		level.sequence++;
		if (tick == 0 || tick == again || again == -2)
			stage_submit(session, &level);
		if (tick == 0 && again == 0) {
			level.sequence++;
			stage_submit(session, &level);
		}
		stage_step(session, 1);
		hashes[tick] = cau_session_hash(session);
	}
	cau_session_destroy(session);
}

static void stated_again_a_level_changes_nothing(void **state)
{
	(void)state;
	cau_scene_def *scene = between_jaws();
	for (int kind = 0; kind < CAU_COMMAND_COUNT; kind++) {
		// Each kind must be in exactly one of the two lists.
		assert_true(levels[kind] != once[kind]);
		for (int variant = 0; variant < MOST && levels[kind]; variant++)
			for (int what = 0; what < BEFORE_COUNT; what++) {
				static const int agains[] = {0, 5, -2};
				uint64_t wanted[TICKS], hashes[TICKS];
				cau_command level = level_of(kind, variant);
				run(scene, (before)what, level, -1, wanted);
				for (size_t i = 0; i < sizeof agains / sizeof *agains; i++) {
					run(scene, (before)what, level, agains[i], hashes);
					for (int tick = 0; tick < TICKS; tick++)
						if (hashes[tick] != wanted[tick])
							fail_msg("command %d (%d) in state %d, again at %d: tick %d differs",
							         kind, variant, what, agains[i], tick);
				}
			}
	}
	free(scene);
}

// Rest is a state of the tissue. A command that changes nothing does not end it.
static void a_level_does_not_wake_tissue_that_rests(void **state)
{
	(void)state;
	cau_scene_def *scene = between_jaws();
	stage_add_tool(scene, "far", CAU_TOOL_GRASPER, 0, 0, 0.1);
	scene->tools[0].pose.position_m[2] = 0.2;
	memset(scene->gravity_m_s2, 0, sizeof scene->gravity_m_s2);
	for (int kind = 0; kind < CAU_COMMAND_COUNT; kind++) {
		if (!levels[kind])
			continue;
		cau_session *session = stage_open(scene, 1);
		cau_command level = level_of(kind, 1);
		stage_submit(session, &level);
		for (int tick = 0; tick < 2000 && !stage_frame(session).statistics.resting; tick++)
			stage_step(session, 1);
		if (stage_frame(session).statistics.resting) {
			bool exact;
			stage_bytes shot = stage_snapshot(session);
			stage_step(session, 1);
			uint64_t hash = cau_session_hash(session);
			assert_int_equal(cau_session_restore(session, shot.bytes, shot.count, &exact, NULL),
			                 CAU_OK);
			free(shot.bytes);
			level.sequence += 2;
			stage_submit(session, &level);
			stage_step(session, 1);
			if (!stage_frame(session).statistics.resting || cau_session_hash(session) != hash)
				fail_msg("command %d wakes tissue that rests", kind);
			assert_true(kind < CAU_COMMAND_TOOL_REMOVE || kind > CAU_COMMAND_TOOL_RELEASE ||
			            stage_tool(session, "jaws")->sequence == level.sequence);
		} else if (kind != CAU_COMMAND_SET_FORCE && kind != CAU_COMMAND_SET_GRAVITY) {
			fail_msg("command %d leaves the tissue moving for ever", kind);
		}
		cau_session_destroy(session);
	}
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stated_again_a_level_changes_nothing),
		cmocka_unit_test(a_level_does_not_wake_tissue_that_rests),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
