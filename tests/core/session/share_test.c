// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that share memory have the same bits as alone, and do not influence each other.
#include "base/memory.h"
#include "core/base/images_here.h"
#include "core/session/busy_scene.h"
#include "session/session_internal.h"

#include <pthread.h>
#include <unistd.h>

enum { LATER = 20 }; // ticks by which the second session begins later

// A session alone is compared with two sessions that share memory. The first creates the image; the
// second begins to share while the first already runs. All three run through cuts, refactorisations
// and a restore.
static void steps_are_those_of_a_session_alone(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	uint64_t hash[BUSY_TICKS];
	cau_session *alone = stage_open(scene, 1), *first = stage_open(scene, 1);
	size_t shared = cau_session_share(first);
	assert_true(shared > 0);
	stage_bytes shot = stage_snapshot(alone);
	for (int tick = 0; tick < BUSY_TICKS; tick++) {
		busy_run(alone, 1);
		hash[tick] = cau_session_hash(alone);
	}
	busy_run(first, LATER);
	cau_session *second = stage_open(scene, 2);
	assert_true(cau_session_share(second) > shared / 2);
	for (int tick = 0; tick < BUSY_TICKS; tick++) {
		if (tick >= LATER)
			busy_run(first, 1);
		busy_run(second, 1);
		uint64_t of_first = hash[tick < LATER ? LATER - 1 : tick];
		if (cau_session_hash(second) != hash[tick] || cau_session_hash(first) != of_first)
			fail_msg("sharing changed tick %d", tick);
	}
	cau_session_destroy(first); // the remaining session continues
	assert_int_equal(cau_session_restore(second, shot.bytes, shot.count, NULL, NULL), CAU_OK);
	for (int tick = 0; tick < BUSY_TICKS; tick++) {
		busy_run(second, 1);
		assert_true(cau_session_hash(second) == hash[tick]);
	}
	cau_session_destroy(second);
	assert_int_equal(cau_image_count(), 0);
	cau_session_destroy(alone);
	free(shot.bytes);
	free(scene);
}

// Returns the bytes of pages with memory of their own, or with shared memory that is not all zero.
static size_t touched_bytes(const cau_session *session)
{
	cau_pages pages[CAU_IMAGE_PARTS];
	size_t page = (size_t)sysconf(_SC_PAGESIZE), count = 0;
	int32_t parts = cau_session_pages(session, pages);
	for (int32_t i = 0; i < parts; i++) {
		size_t n = pages[i].byte_count / page;
		uint8_t *touched = malloc(n + 1);
		assert_non_null(touched);
		cau_pages_touched(&pages[i], touched);
		for (size_t k = 0; k < n; k++)
			count += touched[k];
		free(touched);
	}
	return count * page;
}

// Before anything moves, a session shares most of the memory that it uses.
static void a_further_session_shares_most(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene_light("layers");
	cau_session *first = stage_open(scene, 1);
	assert_true(cau_session_share(first) > 0);
	cau_session *second = stage_open(scene, 1);
	size_t touched = touched_bytes(second), shared = cau_session_share(second);
	print_message("%.1f of %.1f MB\n", 1e-6 * (double)shared, 1e-6 * (double)touched);
	assert_true((double)shared > 0.75 * (double)touched);
	assert_true(touched_bytes(second) < touched / 4); // the rest belongs to the image
	cau_session_destroy(first);
	cau_session_destroy(second);
	free(scene);
}

// Sessions of different tissue have different images.
static void other_tissue_shares_nothing_with_it(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session[2];
	session[0] = stage_open(scene, 1);
	scene->step_s /= 2;
	session[1] = stage_open(scene, 1);
	for (int i = 0; i < 2; i++)
		assert_true(cau_session_share(session[i]) > 0);
	assert_int_equal(cau_image_count(), 2);
	for (int i = 0; i < 2; i++)
		cau_session_destroy(session[i]);
	assert_int_equal(cau_image_count(), 0);
	free(scene);
}

typedef struct desk {
	pthread_t thread;
	uint64_t hash;
} desk;

static void *come_and_go(void *context)
{
	desk *d = context;
	cau_scene_def *scene = busy_scene();
	for (int round = 0; round < 3; round++) {
		cau_session *session = stage_open(scene, 1);
		cau_session_share(session);
		busy_run(session, 30);
		d->hash = cau_session_hash(session);
		cau_session_destroy(session);
	}
	free(scene);
	return NULL;
}

static void sessions_of_several_threads_come_and_go(void **state)
{
	(void)state;
	desk desks[3] = {0};
	for (int i = 0; i < 3; i++)
		assert_int_equal(pthread_create(&desks[i].thread, NULL, come_and_go, &desks[i]), 0);
	for (int i = 0; i < 3; i++)
		assert_int_equal(pthread_join(desks[i].thread, NULL), 0);
	for (int i = 1; i < 3; i++)
		assert_true(desks[i].hash == desks[0].hash);
	assert_int_equal(cau_image_count(), 0);
}

int main(void)
{
	if (!images_here()) {
		print_message("skipped: this system has no sealed files in memory\n");
		return 77;
	}
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(steps_are_those_of_a_session_alone),
		cmocka_unit_test(a_further_session_shares_most),
		cmocka_unit_test(other_tissue_shares_nothing_with_it),
		cmocka_unit_test(sessions_of_several_threads_come_and_go),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
