// SPDX-License-Identifier: GPL-3.0-or-later
// The same commands at the same ticks give the same bits, with any number of threads, and with
// other work beside.
#include "core/session/busy_scene.h"

#include <pthread.h>

// Sessions on one to three threads, and a session whose number of threads changes before each tick.
static void the_hash_does_not_know_the_threads(void **state)
{
	(void)state;
	enum { CHANGING = 3, SESSIONS };
	cau_scene_def *scene = busy_scene();
	busy_tear(scene);
	cau_session *session[SESSIONS];
	for (int i = 0; i < SESSIONS; i++)
		session[i] = stage_open(scene, i < CHANGING ? i + 1 : 3);
	for (int tick = 0; tick < BUSY_TICKS; tick++) {
		cau_session_set_threads(session[CHANGING], 1 + tick % 4);
		for (int i = 0; i < SESSIONS; i++)
			busy_run(session[i], 1);
		for (int i = 1; i < SESSIONS; i++)
			if (cau_session_hash(session[i]) != cau_session_hash(session[0]))
				fail_msg("%s threads differ from one at tick %d",
				         i == CHANGING ? "changing"
				         : i == 1      ? "two"
				                       : "three",
				         tick);
	}
	assert_true(stage_frame(session[0]).statistics.refactorisations > 0);
	for (int i = 0; i < SESSIONS; i++)
		cau_session_destroy(session[i]);
	free(scene);
}

typedef struct worker {
	pthread_t thread;
	int32_t threads;
	uint64_t hash;
} worker;

static void *run_alone(void *context)
{
	worker *w = context;
	cau_scene_def *scene = busy_scene();
	// This system is analysed while other threads analyse the systems of other sessions.
	cau_session *session = stage_open(scene, w->threads);
	busy_run(session, 50);
	w->hash = cau_session_hash(session);
	cau_session_destroy(session);
	free(scene);
	return NULL;
}

static void beside_busy_sessions(void **state)
{
	(void)state;
	worker alone = {.threads = 1};
	run_alone(&alone);
	worker beside[3];
	for (int i = 0; i < 3; i++) {
		beside[i] = (worker){.threads = 1 + i % 2};
		assert_int_equal(pthread_create(&beside[i].thread, NULL, run_alone, &beside[i]), 0);
	}
	for (int i = 0; i < 3; i++)
		assert_int_equal(pthread_join(beside[i].thread, NULL), 0);
	for (int i = 0; i < 3; i++)
		if (beside[i].hash != alone.hash)
			fail_msg("session %d differs from the one that ran alone", i);
}

// A material changes while a factor is computed in the background from the old material.
static void materials_change_beside_the_background(void **state)
{
	(void)state;
	uint64_t hash[2];
	for (int i = 0; i < 2; i++) {
		cau_scene_def *scene = busy_scene();
		cau_session *session = stage_open(scene, 1 + i);
		for (int tick = 0; tick < 50; tick++) {
			cau_command command;
			cau_default_command(&command, CAU_COMMAND_SET_MATERIAL);
			strcpy(command.as.material.layer, "links");
			command.as.material.kind = CAU_LAYER_LINKS;
			command.as.material.link = scene->layers[3].link;
			command.as.material.link.young_modulus_pa = 1e5 + tick;
			if (tick > 10)
				stage_submit(session, &command);
			busy_run(session, 1);
		}
		hash[i] = cau_session_hash(session);
		cau_session_destroy(session);
		free(scene);
	}
	assert_true(hash[0] == hash[1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_hash_does_not_know_the_threads),
		cmocka_unit_test(beside_busy_sessions),
		cmocka_unit_test(materials_change_beside_the_background),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
