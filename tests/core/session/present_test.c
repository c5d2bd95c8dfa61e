// SPDX-License-Identifier: GPL-3.0-or-later
// A session's present definition: it includes queued changes, and a restore brings back the changes
// of the snapshot.
#include "core/session/stage.h"

static cau_scene_def *sheet_scene(void)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	stage_add_sheet(scene, "fascia", 0.04, 0.03, 8, 6);
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, 0, 0, 0.03);
	stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.01, 0, 0.02);
	return scene;
}

static double thickness_of(const cau_session *session, const cau_scene_def *scene,
                           double *gravity_z)
{
	static cau_scene_def present; // too large for a stack
	present = *scene;
	cau_session_present(session, &present);
	*gravity_z = present.gravity_m_s2[2];
	assert_string_equal(present.layers[0].name, "fascia");
	return present.layers[0].sheet[0].thickness_m;
}

static void gravity_and_materials_of_now(void **state)
{
	(void)state;
	cau_scene_def *scene = sheet_scene();
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 1);
	double z, before = thickness_of(session, scene, &z);
	assert_true(z == scene->gravity_m_s2[2] && before == scene->layers[0].sheet[0].thickness_m);
	cau_command material = stage_command(CAU_COMMAND_SET_MATERIAL);
	cau_command gravity = stage_command(CAU_COMMAND_SET_GRAVITY);
	material.as.material.sheet = scene->layers[0].sheet[0];
	material.as.material.sheet.thickness_m = 2 * before;
	gravity.as.gravity_m_s2[2] = -3;
	stage_submit(session, &material);
	stage_submit(session, &gravity);
	assert_true(thickness_of(session, scene, &z) == 2 * before && z == -3);
	stage_step(session, 1);
	assert_true(thickness_of(session, scene, &z) == 2 * before && z == -3);

	size_t capacity = cau_session_snapshot_bytes(session), bytes;
	void *snapshot = malloc(capacity);
	bool exact;
	assert_int_equal(cau_session_snapshot(session, snapshot, capacity, &bytes, NULL), CAU_OK);
	assert_true(thickness_of(other, scene, &z) == before);
	assert_int_equal(cau_session_restore(other, snapshot, bytes, &exact, NULL), CAU_OK);
	assert_true(thickness_of(other, scene, &z) == 2 * before && z == -3);

	// A material for another kind of layer is refused at its tick, and the definition does not
	// include it before.
	material.as.material.kind = CAU_LAYER_FAT;
	cau_default_fat_material(&material.as.material.fat);
	stage_submit(session, &material);
	assert_true(thickness_of(session, scene, &z) == 2 * before);
	free(snapshot);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

static const cau_scene_def *present_of(const cau_session *session, const cau_scene_def *scene)
{
	static cau_scene_def present; // too large for a stack
	present = *scene;
	cau_session_present(session, &present);
	return &present;
}

// One tool is changed, one is removed, one is added. The definition includes these changes at once,
// and is the same after the tick.
static void tools_of_now(void **state)
{
	(void)state;
	cau_scene_def *scene = sheet_scene();
	cau_session *session = stage_open(scene, 1);
	cau_command configure = stage_command(CAU_COMMAND_TOOL_CONFIGURE);
	cau_command remove = stage_command(CAU_COMMAND_TOOL_REMOVE);
	cau_command add = stage_command(CAU_COMMAND_TOOL_ADD);
	configure.as.definition = scene->tools[0];
	configure.as.definition.temperature_c = 900;
	configure.as.definition.pose.position_m[2] = 0.5; // a configuration does not change the pose
	strcpy(remove.tool, "jaws");
	strcpy(add.as.definition.name, "probe");
	stage_submit(session, &configure);
	stage_submit(session, &remove);
	stage_submit(session, &add);
	for (int tick = 0; tick < 2; tick++) {
		const cau_scene_def *present = present_of(session, scene);
		assert_int_equal(present->tool_count, 2);
		assert_string_equal(present->tools[0].name, "hook");
		assert_true(present->tools[0].temperature_c == 900);
		assert_true(present->tools[0].pose.position_m[2] == 0.03);
		assert_string_equal(present->tools[1].name, "probe");
		stage_step(session, 1);
	}

	// Commands that the tick will refuse are not included: adding a tool that exists, and removing
	// a tool that does not.
	strcpy(add.as.definition.name, "hook");
	stage_submit(session, &add);
	stage_submit(session, &remove);
	assert_int_equal(present_of(session, scene)->tool_count, 2);
	cau_session_destroy(session);
	free(scene);
}

// In the definition, a tool that has moved has its present pose.
static void a_moved_tool(void **state)
{
	(void)state;
	cau_scene_def *scene = sheet_scene();
	cau_session *session = stage_open(scene, 1);
	stage_move(session, "hook", 0, 0, 0.04);
	stage_step(session, 60);
	double z = present_of(session, scene)->tools[0].pose.position_m[2];
	assert_true(fabs(z - 0.04) < 1e-9);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gravity_and_materials_of_now),
		cmocka_unit_test(tools_of_now),
		cmocka_unit_test(a_moved_tool),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
