// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots that are damaged or of another tissue are refused, and change nothing. (For forged
// snapshots see snapshot_forged_test.c.)
#include "core/session/unbroken_run.h"

typedef struct victim {
	cau_session *session;
	uint64_t hash;
} victim;

static void expect_refusal(const victim *v, const void *bytes, size_t count, const char *what,
                           size_t where)
{
	// The bytes are restored from a copy of exactly their size, so that a sanitizer detects a read
	// past the end.
	void *copy = malloc(count ? count : 1);
	assert_non_null(copy);
	memcpy(copy, bytes, count);
	cau_error error = {0};
	bool exact;
	cau_status status = cau_session_restore(v->session, copy, count, &exact, &error);
	free(copy);
	if (status != CAU_CORRUPT || !error.reason[0])
		fail_msg("%s at byte %zu gave %s", what, where, cau_status_name(status));
	if (cau_session_hash(v->session) != v->hash)
		fail_msg("%s at byte %zu changed the session", what, where);
}

static void damage_is_refused(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	victim v = {.session = stage_open(scene, 1)};
	busy_run(v.session, 30);
	v.hash = cau_session_hash(v.session);
	const stage_bytes *shot = &run->shot[50];
	unsigned char *bytes = malloc(shot->count + 8);
	assert_non_null(bytes);
	memcpy(bytes, shot->bytes, shot->count);
	const size_t dense = 512; // every byte before this is tested, later bytes are sampled
	for (size_t at = 0; at < shot->count; at += at < dense ? 1 : shot->count / 150) {
		unsigned char flip = (unsigned char)(1u << at % 8);
		bytes[at] ^= flip;
		expect_refusal(&v, bytes, shot->count, "a flipped bit", at);
		bytes[at] ^= flip;
	}
	for (size_t count = 0; count < shot->count; count += count < dense ? 7 : shot->count / 40)
		expect_refusal(&v, bytes, count, "an end", count);
	memset(bytes + shot->count, 0, 8);
	expect_refusal(&v, bytes, shot->count + 8, "more bytes", shot->count);
	expect_refusal(&v, "", 0, "nothing", 0);
	// The session continues as if nothing had been tried.
	expect_the_same(v.session, 30, 40);
	free(bytes);
	cau_session_destroy(v.session);
	free(scene);
}

// The same mesh in another scene counts as another tissue.
static void another_definition_is_refused(void **state)
{
	(void)state;
	for (int what = 0; what < 6; what++) {
		cau_scene_def *scene = busy_scene();
		switch (what) {
		case 0:
			scene->step_s /= 2;
			break;
		case 1:
			scene->iterations++;
			break;
		case 2:
			scene->seed++;
			break;
		case 3:
			scene->parting = CAU_PARTING_ELEMENTS;
			break;
		case 4:
			scene->layers[1].fat[0].density_kg_m3 *= 2;
			break;
		default:
			scene->layers[0].fibre[1] = 1;
			scene->meshes[0].texture_turn_rad = 0.3;
			break;
		}
		victim v = {.session = stage_open(scene, 1)};
		v.hash = cau_session_hash(v.session);
		expect_refusal(&v, run->shot[50].bytes, run->shot[50].count, "another scene", (size_t)what);
		cau_session_destroy(v.session);
		free(scene);
	}
}

static void a_small_buffer_is_refused(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1);
	size_t needed = cau_session_snapshot_bytes(session), count = 0;
	unsigned char *bytes = malloc(needed - 1);
	assert_non_null(bytes);
	cau_error error = {0};
	assert_int_equal(cau_session_snapshot(session, bytes, needed - 1, &count, &error), CAU_LIMIT);
	assert_true(error.reason[0]);
	free(bytes);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(damage_is_refused),
		cmocka_unit_test(another_definition_is_refused),
		cmocka_unit_test(a_small_buffer_is_refused),
	};
	return cmocka_run_group_tests(tests, make_run, drop_run);
}
