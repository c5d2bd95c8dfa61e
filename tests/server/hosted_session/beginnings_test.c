// SPDX-License-Identifier: GPL-3.0-or-later
// The beginnings of scenes that had to settle are found again by the very scene, and few are kept.
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

// Of a session of scene `number`, stepped so many ticks so that snapshots differ.
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

// The tick that the scene's beginning stands at, or -1.
static int64_t found_tick(int number)
{
	cau_scene_def *scene = scene_of(number);
	cau_session_def def = cau_default_session_def();
	cau_session *core = NULL;
	cau_frame frame;
	int64_t tick = -1;
	cau_beginning *found = cau_beginnings_find(&all, scene);
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
	}
	free(scene);
	return tick;
}

static int finish(void **state)
{
	(void)state;
	cau_beginnings_finish(&all);
	for (int i = 0; i < CAU_BEGINNINGS_MOST; i++)
		if (all.kept[i].definition || all.kept[i].snapshot)
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
	cau_beginning_drop(cau_beginnings_find(&all, second));
	free(second);
	assert_int_equal(found_tick(2), -1);
	assert_int_equal(found_tick(1), 3);
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
		cmocka_unit_test_teardown(a_scene_finds_its_own, finish),
		cmocka_unit_test_teardown(what_did_not_settle_is_not_kept, finish),
		cmocka_unit_test_teardown(who_was_asked_for_longest_ago_gives_way, finish),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
