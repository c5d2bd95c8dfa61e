// SPDX-License-Identifier: GPL-3.0-or-later
// The busy scene in a run without a break, with a snapshot of every tick. Tests of snapshots
// compare with it.
#pragma once

#include "core/session/busy_scene.h"
#include "session/session_internal.h"

typedef struct unbroken_run {
	uint64_t hash[BUSY_TICKS + 1]; // hash of the state before each tick, and at the end
	int waiting[BUSY_TICKS + 1];   // number of removed elements that were still in the factor
	int making[BUSY_TICKS + 1];    // 1: a factor was being computed
	stage_bytes shot[BUSY_TICKS + 1];
} unbroken_run;

static unbroken_run *run;

static inline int make_run(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1);
	run = calloc(1, sizeof *run);
	for (int tick = 0; tick <= BUSY_TICKS; tick++) {
		run->hash[tick] = cau_session_hash(session);
		run->waiting[tick] = session->update.waiting_count;
		run->making[tick] = session->update.making;
		run->shot[tick] = stage_snapshot(session);
		if (tick < BUSY_TICKS)
			busy_run(session, 1);
	}
	cau_session_destroy(session);
	free(scene);
	return 0;
}

static inline int drop_run(void **state)
{
	(void)state;
	for (int tick = 0; tick <= BUSY_TICKS; tick++)
		free(run->shot[tick].bytes);
	free(run);
	return 0;
}

static inline void restore(cau_session *session, const stage_bytes *shot)
{
	cau_error error = {0};
	bool exact = false;
	if (cau_session_restore(session, shot->bytes, shot->count, &exact, &error))
		fail_msg("%s", error.reason);
	assert_true(exact);
}

static inline void expect_the_same(cau_session *session, int from, int to)
{
	for (int tick = from; tick <= to; tick++) {
		if (cau_session_hash(session) != run->hash[tick])
			fail_msg("restored at tick %d, the state differs at tick %d", from, tick);
		if (tick < to)
			busy_run(session, 1);
	}
}
