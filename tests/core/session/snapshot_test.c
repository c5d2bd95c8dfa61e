// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots: a session that is stopped, written, read and continued has the same bits as an
// uninterrupted session. (For refused snapshots see snapshot_damage_test.c.)
#include "core/session/unbroken_run.h"

#include "session/session_internal.h"

// Returns the first tick at or after `from` with waiting elements, while a factor is being computed
// or not (`making`).
static int tick_with(int from, int making)
{
	for (int tick = from; tick < BUSY_TICKS; tick++)
		if (run->waiting[tick] && run->making[tick] == making)
			return tick;
	return -1;
}

// Checks that the run is busy. The other tests would prove little if the run did nothing.
static void the_run_is_busy(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1);
	restore(session, &run->shot[BUSY_TICKS]);
	cau_frame frame = stage_frame(session);
	assert_true(frame.statistics.elements_removed > 500);
	assert_true(frame.statistics.refactorisations >= 3);
	assert_true(tick_with(0, 1) > 0);
	int downdated = 0, grasped = 0, charred = 0;
	for (int tick = 0; tick < BUSY_TICKS; tick++) {
		restore(session, &run->shot[tick]);
		downdated += stage_frame(session).statistics.factor_operations > 0;
		grasped += stage_tool(session, "jaws")->grasped_vertices > 0;
		charred += session->shrink.active_count > 0;
	}
	assert_true(downdated > 5);
	assert_true(grasped > 20);
	assert_true(charred > 20);
	cau_session_destroy(session);
	free(scene);
}

static void restored_into_a_fresh_session(void **state)
{
	(void)state;
	int ticks[] = {0, 1, 17, tick_with(10, 1), tick_with(40, 1), tick_with(60, 1) + 1, 80};
	for (size_t k = 0; k < sizeof ticks / sizeof *ticks; k++) {
		cau_scene_def *scene = busy_scene();
		cau_session *session = stage_open(scene, 1 + (int32_t)k % 3);
		restore(session, &run->shot[ticks[k]]);
		expect_the_same(session, ticks[k], ticks[k] + 25 < BUSY_TICKS ? ticks[k] + 25 : BUSY_TICKS);
		cau_session_destroy(session);
		free(scene);
	}
}

static void restored_into_the_same_session(void **state)
{
	(void)state;
	int back = tick_with(40, 1);
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1);
	busy_run(session, 60);
	restore(session, &run->shot[back]); // a rewind
	expect_the_same(session, back, back + 10);
	restore(session, &run->shot[back + 4]); // forward, and back again
	restore(session, &run->shot[5]);
	expect_the_same(session, 5, BUSY_TICKS);
	cau_session_destroy(session);
	free(scene);
}

// A snapshot of a restored session equals the snapshot from which it was restored.
static void written_again_it_is_the_same(void **state)
{
	(void)state;
	int tick = tick_with(40, 1);
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1);
	restore(session, &run->shot[tick]);
	stage_bytes again = stage_snapshot(session);
	assert_int_equal(again.count, run->shot[tick].count);
	assert_memory_equal(again.bytes, run->shot[tick].bytes, again.count);
	free(again.bytes);
	cau_session_destroy(session);
	free(scene);
}

// Exposures of elements that part one by one are part of the state, also exposures of elements that
// have not parted yet.
static void doses_of_elements(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	scene->parting = CAU_PARTING_ELEMENTS;
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 2);
	busy_run(session, 45);
	int32_t before = stage_frame(session).statistics.elements_removed;
	stage_bytes shot = stage_snapshot(session);
	restore(other, &shot);
	free(shot.bytes);
	assert_true(cau_session_hash(other) == cau_session_hash(session));
	for (int tick = 45; tick < BUSY_TICKS; tick++) {
		busy_run(session, 1);
		busy_run(other, 1);
		if (cau_session_hash(session) != cau_session_hash(other))
			fail_msg("restored at tick 45, the state differs at tick %d", tick + 1);
	}
	assert_true(before > 50);
	assert_true(stage_frame(session).statistics.elements_removed > before + 50);
	cau_session_destroy(other);
	cau_session_destroy(session);
	free(scene);
}

// Commands for later ticks, pins and changed materials are part of the state.
static void queued_commands_pins_and_materials(void **state)
{
	(void)state;
	const double least[3] = {-0.1, -0.1, -0.0021}, most[3] = {0.1, -0.01, 0.0021};
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 2);
	busy_run(session, 20);
	cau_command pin, material, later;
	cau_default_command(&pin, CAU_COMMAND_PIN);
	pin.as.selection = stage_box(least, most);
	stage_submit(session, &pin);
	cau_default_command(&material, CAU_COMMAND_SET_MATERIAL);
	material.as.material.kind = CAU_LAYER_FAT;
	strcpy(material.as.material.layer, "fat");
	material.as.material.fat.young_modulus_pa = 9000;
	stage_submit(session, &material);
	cau_default_command(&later, CAU_COMMAND_SET_GRAVITY);
	later.tick = 33;
	later.as.gravity_m_s2[1] = 5;
	stage_submit(session, &later);
	busy_run(session, 5);
	stage_bytes shot = stage_snapshot(session);
	restore(other, &shot);
	for (int tick = 0; tick < 25; tick++) {
		busy_run(session, 1);
		busy_run(other, 1);
		if (cau_session_hash(session) != cau_session_hash(other))
			fail_msg("they differ %d ticks later", tick + 1);
	}
	free(shot.bytes);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

// A session restores its own beginning. The present factor belongs to other materials, or lacks
// elements, or is being computed. Each time the session continues like a fresh session.
static void a_factor_serves_its_own_matrix_alone(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1);
	stage_bytes beginning = stage_snapshot(session);
	uint64_t fresh = 0;
	for (int round = 0; round < 4; round++) {
		if (round == 1) { // round 1 has another matrix; round 0 keeps the first
			cau_command stiffer;
			cau_default_command(&stiffer, CAU_COMMAND_SET_MATERIAL);
			stiffer.as.material.kind = CAU_LAYER_FAT;
			strcpy(stiffer.as.material.layer, "fat");
			stiffer.as.material.fat = scene->layers[1].fat[0];
			stiffer.as.material.fat.young_modulus_pa *= 3;
			stage_submit(session, &stiffer);
			busy_run(session, 2);
		}
		assert_int_equal(cau_session_restore(session, beginning.bytes, beginning.count, NULL, NULL),
		                 CAU_OK);
		busy_run(session, round == 2 ? 30 : BUSY_TICKS); // during the cuts, or after them
		if (round == 2)
			continue;
		if (!round)
			fresh = cau_session_hash(session);
		assert_true(cau_session_hash(session) == fresh);
	}
	cau_session *other = stage_open(scene, 1);
	busy_run(other, BUSY_TICKS);
	assert_true(cau_session_hash(other) == fresh);
	cau_session_destroy(other);
	cau_session_destroy(session);
	free(beginning.bytes);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_run_is_busy),
		cmocka_unit_test(restored_into_a_fresh_session),
		cmocka_unit_test(restored_into_the_same_session),
		cmocka_unit_test(written_again_it_is_the_same),
		cmocka_unit_test(doses_of_elements),
		cmocka_unit_test(queued_commands_pins_and_materials),
		cmocka_unit_test(a_factor_serves_its_own_matrix_alone),
	};
	return cmocka_run_group_tests(tests, make_run, drop_run);
}
