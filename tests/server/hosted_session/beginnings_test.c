// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the cache of rest states. The rest state of a scene that had to settle is found again for
// exactly this scene, and only a few are cached.
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "hosted_session/beginnings.h"
#include "server/double/fake_session.h"

static cau_beginnings all;

static cau_scene_def *scene_of(int number)
{
	cau_scene_def *scene = calloc(1, sizeof *scene);
	assert_non_null(scene);
	cau_default_scene_def(scene);
	snprintf(scene->name, sizeof scene->name, "scene%d", number);
	scene->layer_count = 1;
	cau_default_layer_def(&scene->layers[0], CAU_LAYER_FASCIA);
	snprintf(scene->layers[0].name, sizeof scene->layers[0].name, "sheet");
	return scene;
}

// Stores a snapshot of scene `number` after `ticks` ticks. Different ticks give different
// snapshots.
static void keep(int number, int ticks)
{
	cau_scene_def *scene = scene_of(number);
	cau_session_def def = cau_default_session_def();
	cau_session *core = NULL;
	def.scene = scene;
	assert_int_equal(cau_session_create(&def, &core, NULL), CAU_OK);
	for (int tick = 0; tick < ticks; tick++)
		assert_int_equal(cau_session_step(core, NULL), CAU_OK);
	cau_beginnings_keep(&all, scene, core);
	cau_session_destroy(core);
	free(scene);
}

// Returns the tick of the scene's cached snapshot, or -1.
static int64_t found_tick(int number)
{
	cau_scene_def *scene = scene_of(number);
	cau_session_def def = cau_default_session_def();
	cau_session *core = NULL;
	cau_frame frame;
	int64_t tick = -1;
	cau_beginning *found = cau_beginnings_hold(&all, scene);
	def.scene = scene;
	bool exact = false;
	cau_error error = {0};
	if (found) {
		assert_int_equal(cau_session_create(&def, &core, NULL), CAU_OK);
		assert_int_equal(
			cau_session_restore(core, found->snapshot, found->byte_count, &exact, &error), CAU_OK);
		cau_session_frame(core, &frame);
		tick = (int64_t)frame.tick;
		cau_session_destroy(core);
		cau_beginnings_let_go(&all, found);
	}
	free(scene);
	return tick;
}

static int begin(void **state)
{
	(void)state;
	cau_beginnings_init(&all);
	return 0;
}

static int finish(void **state)
{
	(void)state;
	cau_beginnings_finish(&all);
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++)
		if (all.kept[i])
			return 1;
	return 0;
}

static void a_scene_finds_its_own(void **state)
{
	(void)state;
	cau_fake_hooks_set.tension = true;
	assert_int_equal(found_tick(1), -1);
	keep(1, 3);
	keep(2, 5);
	assert_int_equal(found_tick(1), 3);
	assert_int_equal(found_tick(2), 5);
	assert_int_equal(found_tick(3), -1);
	cau_scene_def *second = scene_of(2);
	cau_beginning *held = cau_beginnings_hold(&all, second);
	cau_beginnings_forget(&all, held);
	assert_int_equal(found_tick(2), -1);
	assert_true(held->byte_count > 0); // the caller that still holds the entry may read it
	assert_int_equal(held->holders, 1);
	cau_beginnings_let_go(&all, held);
	free(second);
	assert_int_equal(found_tick(2), -1);
	assert_int_equal(found_tick(1), 3);
}

// Two sessions of a scene that are created at the same time both settle. The cache keeps one entry.
static void a_scene_has_one_place(void **state)
{
	(void)state;
	cau_fake_hooks_set.tension = true;
	keep(1, 3);
	keep(2, 4);
	keep(1, 5);
	assert_int_equal(found_tick(1), 5);
	assert_int_equal(found_tick(2), 4);
	int places = 0;
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++)
		places += all.kept[i] != NULL;
	assert_int_equal(places, 2);
}

// Holds entries while other threads replace, forget and release them.
static void *hold_and_keep(void *context)
{
	const int *number = context;
	for (int i = 0; i < 40; i++) {
		cau_scene_def *scene = scene_of(i % 3);
		keep(i % 3, *number);
		cau_beginning *held = cau_beginnings_hold(&all, scene);
		if (held && i % 5 == *number % 5)
			cau_beginnings_forget(&all, held);
		if (held && (!held->snapshot || !held->definition))
			*(int *)context = -1;
		if (held)
			cau_beginnings_let_go(&all, held);
		free(scene);
	}
	return NULL;
}

static void several_threads_hold_them(void **state)
{
	(void)state;
	pthread_t thread[3];
	int number[3] = {1, 2, 3};
	cau_fake_hooks_set.tension = true;
	for (int i = 0; i < 3; i++)
		assert_int_equal(pthread_create(&thread[i], NULL, hold_and_keep, &number[i]), 0);
	for (int i = 0; i < 3; i++)
		assert_int_equal(pthread_join(thread[i], NULL), 0);
	for (int i = 0; i < 3; i++)
		assert_int_equal(number[i], i + 1);
}

static void what_did_not_settle_is_not_kept(void **state)
{
	(void)state;
	cau_fake_hooks_set.tension = false;
	keep(1, 3);
	assert_int_equal(found_tick(1), -1);
}

static void who_was_asked_for_longest_ago_gives_way(void **state)
{
	(void)state;
	cau_fake_hooks_set.tension = true;
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++)
		keep(i, i);
	assert_int_equal(found_tick(0), 0);
	keep(100, 1);
	assert_int_equal(found_tick(0), 0);
	assert_int_equal(found_tick(1), -1);
	assert_int_equal(found_tick(2), 2);
	assert_int_equal(found_tick(100), 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_scene_finds_its_own, begin, finish),
		cmocka_unit_test_setup_teardown(a_scene_has_one_place, begin, finish),
		cmocka_unit_test_setup_teardown(several_threads_hold_them, begin, finish),
		cmocka_unit_test_setup_teardown(what_did_not_settle_is_not_kept, begin, finish),
		cmocka_unit_test_setup_teardown(who_was_asked_for_longest_ago_gives_way, begin, finish),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
