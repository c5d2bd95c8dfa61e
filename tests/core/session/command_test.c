// SPDX-License-Identifier: GPL-3.0-or-later
// Commands: absurd commands are refused, extreme commands give bounded steps, and a faulted session
// reports its fault and can be restored.
#include "core/session/stage.h"

#include <stdio.h>

#include "session/session_internal.h"

// Largest allowed distance of a vertex, m. Strays are stopped at 200 times the size of all tissue,
// which is 5 to 8 cm here.
static const double bounded_m = 16;

static void expect_refused(cau_session *session, cau_command *command, double *field,
                           const char *what)
{
	double before = *field;
	for (int k = 0; k < STAGE_ABSURD_COUNT; k++) {
		*field = stage_absurd[k];
		cau_error error = {0};
		cau_status status = cau_session_submit(session, command, &error);
		if (status != CAU_BAD_VALUE || !error.path[0] || !error.reason[0])
			fail_msg("%s = %g gave %s at \"%s\"", what, stage_absurd[k], cau_status_name(status),
			         error.path);
	}
	*field = before;
}

static void absurd_numbers_in_commands(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
#define CHECK(field, default_, least, most, unit, meaning)                                         \
	expect_refused(session, &command, &object->field, #field);
	for (int kind = CAU_COMMAND_TOOL_ADD; kind <= CAU_COMMAND_TOOL_CONFIGURE; kind += 2) {
		cau_command command = stage_command(kind);
		cau_tool_def *object = &command.as.definition;
		CAU_TOOL_TABLE(CHECK)
	}
	cau_command move = stage_command(CAU_COMMAND_TOOL_MOVE);
	for (int c = 0; c < 4; c++) {
		expect_refused(session, &move, &move.as.move.pose.rotation[c], "rotation");
		expect_refused(session, &move, &move.as.move.pose.position_m[c % 3], "position_m");
	}
	expect_refused(session, &move, &move.as.move.jaw, "jaw");
	cau_command gravity = stage_command(CAU_COMMAND_SET_GRAVITY);
	cau_command force = stage_command(CAU_COMMAND_SET_FORCE), pin = stage_command(CAU_COMMAND_PIN);
	force.as.force.selection = pin.as.selection = stage_everything();
	for (int c = 0; c < 3; c++) {
		expect_refused(session, &gravity, &gravity.as.gravity_m_s2[c], "gravity_m_s2");
		expect_refused(session, &force, &force.as.force.force_n[c], "force_n");
		expect_refused(session, &force, &force.as.force.selection.least_m[c], "least_m");
		expect_refused(session, &pin, &pin.as.selection.most_m[c], "most_m");
		expect_refused(session, &pin, &pin.as.selection.center_m[c], "center_m");
	}
	expect_refused(session, &pin, &pin.as.selection.radius_m, "radius_m");
	{
		cau_command command = stage_command(CAU_COMMAND_SET_MATERIAL);
		cau_sheet_material *object = &command.as.material.sheet;
		CAU_SHEET_TABLE(CHECK)
	}
	{
		cau_command command = stage_command(CAU_COMMAND_SET_MATERIAL);
		command.as.material.kind = CAU_LAYER_FAT;
		cau_fat_material *object = &command.as.material.fat;
		CAU_FAT_TABLE(CHECK)
	}
#undef CHECK
	cau_command nothing = stage_command(CAU_COMMAND_PIN);
	nothing.kind = CAU_COMMAND_COUNT;
	cau_error error = {0};
	assert_int_equal(cau_session_submit(session, &nothing, &error), CAU_BAD_VALUE);
	// None of these commands was queued.
	stage_step(session, 3);
	assert_int_equal(stage_frame(session).refusal_count, 0);
	cau_session_destroy(session);
	free(scene);
}

static void expect_refusal_at_tick(cau_session *session, cau_command command, cau_status expected)
{
	stage_submit(session, &command);
	stage_step(session, 1);
	cau_frame frame = stage_frame(session);
	assert_int_equal(frame.refusal_count, 1);
	if (frame.refusals[0].status != expected || !frame.refusals[0].path[0])
		fail_msg("command %d gave %s at \"%s\"", command.kind,
		         cau_status_name(frame.refusals[0].status), frame.refusals[0].path);
	stage_step(session, 1);
	assert_int_equal(stage_frame(session).refusal_count, 0);
}

static void what_only_the_tick_can_tell(void **state)
{
	(void)state;
	const double least[3] = {5, 5, 5}, most[3] = {6, 6, 6};
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	for (int kind = CAU_COMMAND_TOOL_REMOVE; kind <= CAU_COMMAND_TOOL_RELEASE; kind++) {
		cau_command command = stage_command(kind);
		strcpy(command.tool, "nobody");
		expect_refusal_at_tick(session, command, CAU_NOT_FOUND);
	}
	// A hook cannot grasp.
	expect_refusal_at_tick(session, stage_command(CAU_COMMAND_TOOL_GRASP), CAU_BAD_STATE);
	cau_command add = stage_command(CAU_COMMAND_TOOL_ADD);
	strcpy(add.as.definition.name, "jaws");
	expect_refusal_at_tick(session, add, CAU_ALREADY_EXISTS);
	cau_command pin = stage_command(CAU_COMMAND_PIN), force = stage_command(CAU_COMMAND_SET_FORCE);
	pin.as.selection = force.as.force.selection = stage_box(least, most);
	expect_refusal_at_tick(session, pin, CAU_NOT_FOUND);
	expect_refusal_at_tick(session, force, CAU_NOT_FOUND);
	cau_command material = stage_command(CAU_COMMAND_SET_MATERIAL);
	strcpy(material.as.material.layer, "fat"); // the material is for a sheet
	expect_refusal_at_tick(session, material, CAU_BAD_VALUE);
	strcpy(material.as.material.layer, "nobody");
	expect_refusal_at_tick(session, material, CAU_NOT_FOUND);
	for (int k = 0; k < CAU_MAX_TOOLS - 2; k++) {
		add = stage_command(CAU_COMMAND_TOOL_ADD);
		snprintf(add.as.definition.name, sizeof add.as.definition.name, "extra%d", k);
		stage_submit(session, &add);
	}
	stage_step(session, 1);
	assert_int_equal(stage_frame(session).tool_count, CAU_MAX_TOOLS);
	strcpy(add.as.definition.name, "more");
	expect_refusal_at_tick(session, add, CAU_LIMIT);
	cau_session_destroy(session);
	free(scene);
}

// Of a million commands the queue accepts its capacity, and the others are refused at once. One
// tick executes all queued commands.
static void a_million_commands(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	int taken = 0, refused = 0;
	for (int k = 0; k < 1000000; k++) {
		cau_command move = stage_command(CAU_COMMAND_TOOL_MOVE);
		cau_error error = {0};
		cau_status status = cau_session_submit(session, &move, &error);
		taken += status == CAU_OK;
		refused += status == CAU_LIMIT && error.reason[0];
	}
	assert_int_equal(taken, cau_default_session_def().command_capacity);
	assert_int_equal(taken + refused, 1000000);
	stage_step(session, 1);
	cau_command move = stage_command(CAU_COMMAND_TOOL_MOVE);
	stage_submit(session, &move); // the queue has capacity again
	cau_session_destroy(session);
	free(scene);
}

// More commands are refused in a tick than a frame can list.
static void many_refusals_in_a_tick(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	for (int k = 0; k < 500; k++) {
		cau_command grasp = stage_command(CAU_COMMAND_TOOL_GRASP);
		stage_submit(session, &grasp);
	}
	stage_step(session, 1);
	assert_int_equal(stage_frame(session).refusal_count, CAU_MAX_REFUSALS);
	cau_session_destroy(session);
	free(scene);
}

// ---- extremes
static double farthest(const cau_session *session)
{
	cau_session_info info = stage_info(session);
	cau_frame frame = stage_frame(session);
	for (int32_t i = 0; i < 3 * info.vertex_count; i++)
		assert_true(isfinite(frame.position[i]) && isfinite(frame.velocity[i]));
	return stage_farthest(&frame, info.rest_position, info.vertex_count);
}

// Steps the session. Each step must be bounded, or fault the session with a reason. Returns 0 after
// a fault.
static int step_or_fault(cau_session *session, int ticks)
{
	cau_error error = {0};
	for (int k = 0; k < ticks; k++) {
		cau_status status = cau_session_step(session, &error);
		if (status) {
			assert_int_equal(status, CAU_NUMERICAL);
			assert_true(error.reason[0]);
			assert_true(farthest(session) < bounded_m); // the frame shows the last good state
			return 0;
		}
		assert_true(farthest(session) < bounded_m);
	}
	return 1;
}

static void huge_forces_and_gravity(void **state)
{
	(void)state;
	for (int what = 0; what < 4; what++) {
		cau_scene_def *scene = stage_layered();
		cau_session *session = stage_open(scene, 1);
		const double least[3] = {-1, -1, -0.009}, most[3] = {1, 1, 1};
		if (what < 2) // the largest gravity that is accepted
			stage_gravity(session, 0, what ? 100 : 0, what ? 0 : -100);
		else // 1,000 N on each vertex of a few grams of tissue
			stage_force(session, stage_box(least, most), 0, 0, what == 2 ? 1000 : -1000);
		int done = step_or_fault(session, 60);
		print_message("case %d: %s, farthest %.3g m, %d inverted\n", what,
		              done ? "done" : "faulted", farthest(session),
		              stage_frame(session).statistics.inverted);
		cau_session_destroy(session);
		free(scene);
	}
}

// A free body beside a pinned body is stopped far below. Its fall of half a minute does not disturb
// the pinned body.
static void what_falls_for_ever_is_stopped(void **state)
{
	(void)state;
	const double size[3] = {0.04, 0.03, 0.01}, least[3] = {-1, -1, -0.0101},
				 most[3] = {1, 1, -0.0099};
	const int32_t cells[3] = {6, 5, 2}, few[3] = {2, 2, 1};
	const double at_rest_m_s = 1e-4; // largest speed of vertices at rest
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	scene->damping_per_s = 1;
	stage_add_slab(scene, "held", size, cells);
	cau_layer_def *loose = stage_add_slab(scene, "loose", size, few);
	stage_mesh_of(scene, loose)->translate_m[2] = 0.05;
	stage_pin_box(scene, least, most);
	cau_session *session = stage_open(scene, 1);
	for (int tick = 0; tick < 1800; tick += 100) {
		stage_step(session, 100);
		assert_true(farthest(session) < bounded_m);
	}
	cau_frame frame = stage_frame(session);
	assert_int_equal(frame.statistics.frozen_vertices, 3 * 3 * 2);
	double speed = 0;
	for (int32_t i = 0; i < 3 * stage_info(session).vertex_count; i++)
		speed = fmax(speed, fabs(frame.velocity[i]));
	if (!(speed < at_rest_m_s))
		fail_msg("something still moves at %g m/s", speed);
	cau_session_destroy(session);
	free(scene);
}

static int32_t frozen(const cau_session *session)
{
	return stage_frame(session).statistics.frozen_vertices;
}

static int32_t recount_frozen(const cau_session *session)
{
	int32_t count = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		count += session->vertices.fixed[v] && !session->vertices.pinned[v];
	return count;
}

// A pinned vertex does not count as frozen, even if it was frozen before. After unpinning, a vertex
// without an element is frozen again, and a vertex that had only moved too far is free.
static void pins_take_frozen_vertices_over(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 1);
	int32_t alone = 0;
	while (session->vertices.fixed[alone])
		alone++;
	int32_t strayed = alone + 1;
	assert_false(session->vertices.fixed[strayed]);
	session->dissection.live_elements[alone] = 0; // as if the vertex's last element had parted
	session->vertices.fixed[alone] = session->vertices.fixed[strayed] = 1;
	session->vertices.frozen_count = 2;
	cau_command command = stage_command(CAU_COMMAND_PIN);
	command.as.selection = stage_everything();
	// A wrong count would fall below zero after some rounds.
	for (int round = 0; round < 3; round++) {
		command.kind = CAU_COMMAND_PIN;
		stage_submit(session, &command);
		stage_step(session, 1);
		assert_int_equal(frozen(session), 0);
		assert_int_equal(frozen(session), recount_frozen(session));
		command.kind = CAU_COMMAND_UNPIN;
		stage_submit(session, &command);
		stage_step(session, 1);
		assert_int_equal(frozen(session), 1);
		assert_int_equal(frozen(session), recount_frozen(session));
	}
	cau_session_destroy(session);
	free(scene);
}

// A tool whose command is a metre away moves through the body at its greatest speed.
static void a_tool_that_leaps(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	for (int leap = 0; leap < 6; leap++) {
		cau_pose pose = {.position_m = {leap % 2 ? 1 : -1, 0, leap % 3 ? -0.002 : 0.5},
		                 .rotation = {0, leap % 2, 1 - leap % 2, 0}};
		stage_turn(session, "hook", &pose);
		stage_turn(session, "jaws", &pose);
		for (int k = 0; k < 40; k++) {
			cau_vec3 before = cau_vec3_of(stage_tool(session, "hook")->pose.position_m);
			stage_step(session, 1);
			cau_vec3 after = cau_vec3_of(stage_tool(session, "hook")->pose.position_m);
			double most = scene->tools[0].max_speed_m_s * info.step_s;
			// The bound allows 1e-9 for rounding.
			assert_true(cau_length(cau_sub(after, before)) <= most * (1 + 1e-9));
			assert_true(farthest(session) < 0.5);
		}
	}
	// Once both tools are gone, the tissue returns to rest.
	stage_move(session, "hook", 0, 0, 0.9);
	stage_move(session, "jaws", 0, 0, 0.9);
	stage_step(session, 400);
	assert_int_equal(stage_frame(session).statistics.inverted, 0);
	cau_session_destroy(session);
	free(scene);
}

// ---- faults
static void a_faulted_session_waits_for_a_snapshot(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 1);
	stage_step(session, 10);
	stage_bytes shot = stage_snapshot(session);
	session->vertices.velocity[100] = NAN; // no command can cause this
	cau_error error = {0};
	assert_int_equal(cau_session_step(session, &error), CAU_NUMERICAL);
	assert_true(error.reason[0]);
	assert_true(isfinite(farthest(session)));
	for (int k = 0; k < 3; k++)
		assert_int_equal(cau_session_step(session, &error), CAU_FAULTED);
	// A snapshot of a faulted session restores a faulted session.
	stage_bytes faulted = stage_snapshot(session);
	bool exact;
	assert_int_equal(cau_session_restore(other, faulted.bytes, faulted.count, &exact, &error),
	                 CAU_OK);
	assert_int_equal(cau_session_step(other, &error), CAU_FAULTED);
	assert_int_equal(cau_session_restore(session, shot.bytes, shot.count, &exact, &error), CAU_OK);
	assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, &error), CAU_OK);
	stage_step(session, 10);
	stage_step(other, 10);
	assert_true(cau_session_hash(session) == cau_session_hash(other));
	free(shot.bytes);
	free(faulted.bytes);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

// ---- moving supports
static void only_pinned_vertices_are_driven(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	cau_error error = {0};
	int32_t pinned = -1, unpinned = -1;
	for (int32_t v = 0; v < info.vertex_count; v++)
		*(session->vertices.pinned[v] ? &pinned : &unpinned) = v;
	double at[3] = {0.001, 0.002, -0.01};
	assert_int_equal(cau_session_drive(session, 1, &unpinned, at, &error), CAU_BAD_STATE);
	const int32_t beyond[] = {-1, info.vertex_count, INT32_MAX};
	for (int k = 0; k < 3; k++)
		assert_int_equal(cau_session_drive(session, 1, &beyond[k], at, &error), CAU_BAD_VALUE);
	assert_int_equal(cau_session_drive(session, -1, &pinned, at, &error), CAU_BAD_VALUE);
	for (int k = 0; k < STAGE_ABSURD_COUNT; k++) {
		double absurd_place[3] = {0, stage_absurd[k], 0};
		assert_int_equal(cau_session_drive(session, 1, &pinned, absurd_place, &error),
		                 CAU_BAD_VALUE);
	}
	assert_int_equal(cau_session_drive(session, 1, &pinned, at, &error), CAU_OK);
	stage_step(session, 1);
	cau_frame frame = stage_frame(session);
	assert_memory_equal(frame.position + 3 * (size_t)pinned, at, sizeof at);
	int told = 0;
	for (int32_t k = 0; k < frame.moved_count; k++)
		told |= frame.moved[k] == pinned;
	assert_true(told);
	stage_step(session, 1); // the vertex stays where it was led
	assert_memory_equal(stage_frame(session).position + 3 * (size_t)pinned, at, sizeof at);
	cau_session_destroy(session);
	free(scene);
}

// Repeated pinning and unpinning does not increase the session's memory.
static void pinning_does_not_grow_the_session(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	size_t once = 0;
	for (int k = 0; k < 20; k++) {
		cau_command pin;
		cau_default_command(&pin, k % 2 ? CAU_COMMAND_UNPIN : CAU_COMMAND_PIN);
		pin.as.selection = stage_everything();
		pin.as.selection.least_m[0] = 0.01;
		stage_submit(session, &pin);
		stage_step(session, 2);
		size_t bytes = session->memory.arena.byte_count + session->memory.rebuilt.byte_count;
		if (k == 1)
			once = bytes;
		assert_true(k <= 1 || bytes <= once + 4096);
	}
	cau_session_destroy(session);
	free(scene);
}

// Vertices that are pinned at run time keep their position to the bit. Unpinned vertices move
// again.
static void pinned_on_the_way(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	size_t bytes = 3 * (size_t)info.vertex_count * sizeof(double);
	double *before = malloc(bytes);
	assert_non_null(before);
	stage_step(session, 7); // the fascia swings on its links
	cau_command pin;
	cau_default_command(&pin, CAU_COMMAND_PIN);
	pin.as.selection = stage_everything();
	pin.as.selection.least_m[0] = 0; // half of the tissue
	stage_submit(session, &pin);
	memcpy(before, stage_frame(session).position, bytes);
	stage_step(session, 20);
	cau_frame frame = stage_frame(session);
	int still = 0, moved = 0;
	for (size_t v = 0; v < (size_t)info.vertex_count; v++) {
		int same = !memcmp(frame.position + 3 * v, before + 3 * v, 3 * sizeof(double));
		if (session->vertices.pinned[v] && !same)
			fail_msg("pinned vertex %zu moved", v);
		still += session->vertices.pinned[v];
		moved += !same;
	}
	assert_true(still > 50 && moved > 50);
	pin.kind = CAU_COMMAND_UNPIN;
	stage_submit(session, &pin);
	stage_step(session, 20);
	frame = stage_frame(session);
	for (size_t v = 0; v < (size_t)info.vertex_count; v++)
		assert_true(memcmp(frame.position + 3 * v, before + 3 * v, 3 * sizeof(double)) != 0 ||
		            session->vertices.pinned[v]);
	free(before);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(absurd_numbers_in_commands),
		cmocka_unit_test(what_only_the_tick_can_tell),
		cmocka_unit_test(a_million_commands),
		cmocka_unit_test(many_refusals_in_a_tick),
		cmocka_unit_test(huge_forces_and_gravity),
		cmocka_unit_test(what_falls_for_ever_is_stopped),
		cmocka_unit_test(pins_take_frozen_vertices_over),
		cmocka_unit_test(a_tool_that_leaps),
		cmocka_unit_test(a_faulted_session_waits_for_a_snapshot),
		cmocka_unit_test(only_pinned_vertices_are_driven),
		cmocka_unit_test(pinned_on_the_way),
		cmocka_unit_test(pinning_does_not_grow_the_session),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
