// SPDX-License-Identifier: GPL-3.0-or-later
// The contact records of tools: they predict the force at the next pose, change no step, and exist
// only while they are watched.
#include "core/session/stage.h"

static const double tick_s = 1.0 / 60;

// Returns a scene: a ball of 3 mm above the middle of a slab of elastic fat, whose top is at z = 0.
static cau_scene_def *ball_on_slab(void)
{
	const double size[3] = {0.04, 0.04, 0.012};
	const double least[3] = {-1, -1, -0.0121}, most[3] = {1, 1, -0.0119};
	const int32_t cells[3] = {20, 20, 6};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_slab(scene, "fat", size, cells)->fat[0].young_modulus_pa = 20e3;
	stage_pin_box(scene, least, most);
	stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0.006);
	scene->damping_per_s = 20; // the tissue is at rest within a second
	return scene;
}

static cau_tool_contact contact_of(const cau_session *session)
{
	cau_frame frame = stage_frame(session);
	assert_non_null(frame.contacts);
	return frame.contacts[0];
}

static double along(const double m[6], const double n[3])
{
	return m[0] * n[0] * n[0] + m[1] * n[1] * n[1] + m[2] * n[2] * n[2] +
	       2 * (m[3] * n[0] * n[1] + m[4] * n[0] * n[2] + m[5] * n[1] * n[2]);
}

static void go(cau_session *session, double x, double y, double z, int32_t ticks)
{
	stage_move(session, "ball", x, y, z);
	stage_step(session, ticks);
}

static void records_are_there_while_watched(void **state)
{
	(void)state;
	cau_scene_def *scene = ball_on_slab();
	cau_session *session = stage_open(scene, 1);
	assert_null(stage_frame(session).contacts);
	cau_session_watch(session, CAU_CHANNEL_TOOL_CONTACT);
	cau_tool_contact contact = contact_of(session);
	assert_false(contact.valid); // no step was made yet
	assert_string_equal(contact.name, "ball");
	stage_step(session, 1);
	contact = contact_of(session);
	assert_true(contact.valid && contact.plane_count == 0);
	assert_true(contact.time_s == tick_s);
	assert_memory_equal(&contact.pose, &contact.asked_pose, sizeof contact.pose);
	double coupling = 0.004 / scene->tools[0].force_max_n;
	assert_true(fabs(contact.compliance_m_n[2] - coupling) < 1e-12);
	size_t bytes = cau_session_snapshot_bytes(session), used;
	void *snapshot = malloc(bytes);
	bool exact;
	cau_error error;
	assert_int_equal(cau_session_snapshot(session, snapshot, bytes, &used, &error), CAU_OK);
	assert_int_equal(cau_session_restore(session, snapshot, used, &exact, &error), CAU_OK);
	assert_false(contact_of(session).valid);
	stage_step(session, 1);
	assert_true(contact_of(session).valid);
	cau_session_watch(session, 0);
	assert_null(stage_frame(session).contacts);
	cau_session_watch(session, CAU_CHANNEL_TOOL_CONTACT);
	assert_false(contact_of(session).valid);
	free(snapshot);
	cau_session_destroy(session);
	free(scene);
}

// The offsets of planes agree with the record's force. Tissue that is near has planes before the
// tool touches it.
static void planes_fit_the_force(void **state)
{
	(void)state;
	cau_scene_def *scene = ball_on_slab();
	cau_session *session = stage_open(scene, 1);
	cau_session_watch(session, CAU_CHANNEL_TOOL_CONTACT);
	go(session, 0, 0, 0.0035, 30);
	cau_tool_contact near = contact_of(session);
	assert_true(near.plane_count > 0);
	assert_true(stage_tool(session, "ball")->raw_force_n[2] == 0);
	double first = -1;
	for (int32_t i = 0; i < near.plane_count; i++)
		first = fmax(first, near.plane[i].offset_m / near.plane[i].normal[2]);
	assert_true(fabs(first - 0.003) < 2e-4); // the height at which the ball of 3 mm touches
	go(session, 0, 0, 0.0015, 60);
	cau_tool_contact contact = contact_of(session);
	const cau_tool_state *tool = stage_tool(session, "ball");
	assert_memory_equal(contact.force_n, tool->raw_force_n, sizeof contact.force_n);
	assert_true(contact.force_n[2] > 0.05 && contact.plane_count > 0);
	int32_t touching = 0;
	// Friction is part of the force, but not of the planes. Friction moves the position by at most
	// `slack`.
	double slack =
		tool->definition.friction * cau_length(cau_vec3_of(contact.force_n)) *
		fmax(contact.compliance_m_n[0], fmax(contact.compliance_m_n[1], contact.compliance_m_n[2]));
	for (int32_t i = 0; i < contact.plane_count; i++) {
		const cau_contact_plane *plane = &contact.plane[i];
		const double *n = plane->normal, *f = contact.force_n, *c = contact.compliance_m_n;
		double moved = n[0] * (c[0] * f[0] + c[3] * f[1] + c[4] * f[2]) +
		               n[1] * (c[3] * f[0] + c[1] * f[1] + c[5] * f[2]) +
		               n[2] * (c[4] * f[0] + c[5] * f[1] + c[2] * f[2]);
		double gap = cau_dot(cau_vec3_of(n), cau_vec3_of(contact.asked_pose.position_m)) + moved -
		             plane->offset_m;
		assert_true(fabs(cau_length(cau_vec3_of(n)) - 1) < 1e-12);
		assert_true(gap > -slack);
		touching += gap < slack;
	}
	assert_true(touching > 0);
	cau_session_destroy(session);
	free(scene);
}

// Compares the force that the record predicts for the next pose with the force of the session at
// rest there.
static void compliance_is_that_of_the_tissue(void **state)
{
	(void)state;
	const double steps_m[2] = {-5e-5, 5e-5};
	for (double depth_m = 0.0006; depth_m < 0.0031; depth_m += 0.0006) {
		cau_scene_def *scene = ball_on_slab();
		cau_session *session = stage_open(scene, 1);
		cau_session_watch(session, CAU_CHANNEL_TOOL_CONTACT);
		go(session, 0.0003, -0.0002, 0.003 - depth_m, 90);
		cau_tool_contact contact = contact_of(session);
		double measured = 0, force = contact.force_n[2], z = 0.003 - depth_m;
		for (int i = 0; i < 2; i++) {
			go(session, 0.0003, -0.0002, z + steps_m[i], 90);
			measured += (stage_tool(session, "ball")->raw_force_n[2] - force) / -steps_m[i] / 2;
		}
		double said = 1 / along(contact.compliance_m_n, (double[]){0, 0, 1});
		print_message("%.1f mm deep: %.3f N, %.1f N/m, measured %.1f N/m\n", 1e3 * depth_m, force,
		              said, measured);
		assert_true(fabs(said / measured - 1) < 0.2);

		cau_session_destroy(session);
		free(scene);
	}
}

static uint64_t hash_of_run(bool watched, int32_t threads)
{
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, threads);
	if (watched)
		cau_session_watch(session, CAU_CHANNEL_TOOL_CONTACT);
	for (int tick = 0; tick < 60; tick++) {
		stage_move(session, "hook", 1e-4 * tick, 0, 0.03 - 7e-4 * tick);
		stage_step(session, 1);
	}
	if (watched) // the ball pressed, so there was contact to compute
		assert_true(contact_of(session).plane_count > 0);
	uint64_t hash = cau_session_hash(session);
	cau_session_destroy(session);
	free(scene);
	return hash;
}

static void no_step_changes_by_it(void **state)
{
	(void)state;
	uint64_t plain = hash_of_run(false, 1);
	assert_true(hash_of_run(true, 1) == plain);
	assert_true(hash_of_run(true, 2) == plain);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(records_are_there_while_watched),
		cmocka_unit_test(planes_fit_the_force),
		cmocka_unit_test(compliance_is_that_of_the_tissue),
		cmocka_unit_test(no_step_changes_by_it),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
