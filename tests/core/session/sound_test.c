// SPDX-License-Identifier: GPL-3.0-or-later
// Tools or commands of a session are corrupted in memory. The next step faults the session, in
// every build, and changes nothing.
#include "core/session/stage.h"

#include <math.h>

#include "session/session_internal.h"

static void spoil_tool_count(cau_session *session)
{
	session->tool_count = CAU_MAX_TOOLS + 1;
}

static void spoil_tool_count_below(cau_session *session)
{
	session->tool_count = -1;
}

static void spoil_command_count(cau_session *session)
{
	session->queue.count = session->queue.capacity + 1;
}

static void spoil_shape(cau_session *session)
{
	session->tool[0].state.definition.shape = 4000;
}

static void spoil_name(cau_session *session)
{
	memset(session->tool[0].state.name, 'x', sizeof session->tool[0].state.name);
}

static void spoil_pose(cau_session *session)
{
	session->tool[0].state.pose.position_m[1] = NAN;
}

static void spoil_turn(cau_session *session)
{
	memset(session->tool[0].anchor.rotation, 0, sizeof session->tool[0].anchor.rotation);
}

static void spoil_jaw(cau_session *session)
{
	session->tool[0].state.jaw = -1;
}

static void spoil_grasp(cau_session *session)
{
	session->tool[0].grasp_count = 1000000;
}

static void spoil_hold(cau_session *session)
{
	session->tool[0].grasp_count = 1;
	session->tool[0].state.grasping = false;
}

static void spoil_grid(cau_session *session)
{
	session->tool[0].grid.field[0].temperature = NULL;
}

static void (*const spoils[])(cau_session *session) = {
	spoil_tool_count,    spoil_tool_count_below,
	spoil_command_count, spoil_shape,
	spoil_name,          spoil_pose,
	spoil_turn,          spoil_jaw,
	spoil_grasp,         spoil_hold,
	spoil_grid,
};

static void a_spoilt_session_does_not_step(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	for (size_t i = 0; i < sizeof spoils / sizeof *spoils; i++) {
		cau_session *session = stage_open(scene, 1);
		cau_error error = {0};
		stage_energize(session, "hook", 1);
		stage_step(session, 3);
		size_t bytes = 3 * (size_t)session->tissue.vertex_count * sizeof(double);
		double *before = malloc(bytes);
		memcpy(before, session->vertices.position, bytes);
		cau_tool spared = session->tool[0];
		int32_t tools = session->tool_count, commands = session->queue.count;
		spoils[i](session);
		assert_int_equal(cau_session_step(session, &error), CAU_FAULTED);
		assert_non_null(strstr(error.reason, "safety rule"));
		assert_memory_equal(before, session->vertices.position, bytes);
		assert_int_equal(session->tick, 3);
		// Restores the members, so that the session can be destroyed.
		session->tool[0] = spared;
		session->tool_count = tools;
		session->queue.count = commands;
		assert_int_equal(cau_session_step(session, &error), CAU_FAULTED);
		cau_session_destroy(session);
		free(before);
	}
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_spoilt_session_does_not_step),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
