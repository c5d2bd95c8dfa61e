// SPDX-License-Identifier: GPL-3.0-or-later
// Measures a class: many sessions of one scene in real time, a few of them driven, on a few
// workers. There is no daemon, so only steps take time. A daemon can serve this number of sessions
// at most.
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"
#include "session/session_internal.h"

enum { SETTLE_TICKS = 600, WARM_UP_TICKS = 120 };

typedef struct desk {
	cau_session *session;
	double first_due_s;
	int64_t ticks;   // ticks so far
	int64_t counted; // ticks at the start of the measurement
	bool busy;       // a worker computes this desk
	bool driven, failed;
} desk;

typedef struct classroom {
	const cau_cut_def *cut;
	double step_s, end_s;
	double first_bytes; // memory of the program with one session after its first steps
	desk *desks;
	int32_t count;
	pthread_mutex_t mutex; // guards the members of desks except their sessions
} classroom;

static double due_s(const classroom *room, const desk *d)
{
	return d->first_due_s + (double)d->ticks * room->step_s;
}

static void sleep_until(double when_s)
{
	struct timespec at = {.tv_sec = (time_t)when_s,
	                      .tv_nsec = (long)(1e9 * (when_s - floor(when_s)))};
	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL) == EINTR)
		;
}

// ---- the tool's motion: along the scene's cut and back at its speed, energy on every other way
static double way_s(const cau_cut_def *cut)
{
	double square = 0;
	for (int c = 0; c < 3; c++)
		square += (cut->to_m[c] - cut->from_m[c]) * (cut->to_m[c] - cut->from_m[c]);
	return sqrt(square) / cut->speed_m_s;
}

static void drive(const classroom *room, desk *d)
{
	const cau_cut_def *cut = room->cut;
	double ways = (double)d->ticks * room->step_s / way_s(cut), part = fmod(ways, 1);
	bool back = fmod(ways, 2) >= 1, was_back = fmod(ways - room->step_s / way_s(cut), 2) >= 1;
	cau_command move = {.kind = CAU_COMMAND_TOOL_MOVE}, light = {.kind = CAU_COMMAND_TOOL_ENERGIZE};
	double share = back ? 1 - part : part;
	for (int c = 0; c < 3; c++)
		move.as.move.pose.position_m[c] = cut->from_m[c] + share * (cut->to_m[c] - cut->from_m[c]);
	memcpy(move.as.move.pose.rotation, cut->rotation, sizeof cut->rotation);
	snprintf(move.tool, sizeof move.tool, "%s", cut->tool);
	bench_submit(d->session, &move);
	if (d->ticks && back == was_back)
		return;
	light.as.energized = !back;
	snprintf(light.tool, sizeof light.tool, "%s", cut->tool);
	bench_submit(d->session, &light);
}

// ---- the workers
// Takes the free desk whose tick is due first. Returns NULL if every desk is busy.
static desk *take(classroom *room)
{
	desk *first = NULL;
	pthread_mutex_lock(&room->mutex);
	for (int32_t i = 0; i < room->count; i++) {
		desk *d = &room->desks[i];
		if (!d->busy && !d->failed && (!first || due_s(room, d) < due_s(room, first)))
			first = d;
	}
	if (first)
		first->busy = true;
	pthread_mutex_unlock(&room->mutex);
	return first;
}

static void put_back(classroom *room, desk *d, bool stepped)
{
	pthread_mutex_lock(&room->mutex);
	d->busy = false;
	d->ticks += stepped;
	pthread_mutex_unlock(&room->mutex);
}

static void *work(void *context)
{
	classroom *room = context;
	for (desk *d; bench_now_s() < room->end_s && (d = take(room));) {
		double when = due_s(room, d);
		if (when >= room->end_s) {
			put_back(room, d, false);
			break;
		}
		if (bench_now_s() < when)
			sleep_until(when);
		if (d->driven)
			drive(room, d);
		cau_error error = {0};
		d->failed = cau_session_step(d->session, &error) != CAU_OK;
		if (d->failed)
			fprintf(stderr, "cautery-bench: %s\n", error.reason);
		put_back(room, d, true);
	}
	return NULL;
}

// Steps the sessions until `end_s`.
static int work_until(classroom *room, int32_t workers, double end_s)
{
	pthread_t thread[16];
	int32_t started = 0;
	room->end_s = end_s;
	while (started < workers && !pthread_create(&thread[started], NULL, work, room))
		started++;
	for (int32_t i = 0; i < started; i++)
		pthread_join(thread[i], NULL);
	return started == workers ? 0 : 1;
}

// ---- setting up
// Returns the memory of this program. A page that is shared counts in proportion, so a page that
// sessions might share counts once.
static double proportional_bytes(void)
{
	char line[256];
	double kib = 0;
	FILE *file = fopen("/proc/self/smaps_rollup", "r");
	while (file && fgets(line, sizeof line, file))
		if (sscanf(line, "Pss: %lf", &kib) == 1)
			break;
	if (file)
		fclose(file);
	return 1024 * kib;
}

// Creates a session. If `first` is NULL, the session steps until its tissue has settled. Else the
// session starts from the state of `first`.
static cau_session *seat(const cau_scene_def *scene, const cau_session *first)
{
	cau_session_def def = cau_default_session_def();
	cau_session *session = NULL;
	cau_error error = {0};
	def.scene = scene;
	def.unsettled = first != NULL;
	cau_status status = cau_session_create(&def, &session, &error);
	size_t bytes = first ? cau_session_snapshot_bytes(first) : 0;
	void *shot = malloc(bytes + 1);
	if (!status && first)
		status = cau_session_snapshot(first, shot, bytes, &bytes, &error);
	if (!status && first)
		status = cau_session_restore(session, shot, bytes, NULL, &error);
	free(shot);
	if (!status)
		cau_session_share(session);
	if (status) {
		fprintf(stderr, "cautery-bench: %s %s\n", error.path, error.reason);
		cau_session_destroy(session);
		return NULL;
	}
	return session;
}

// Creates all sessions. They have been running for a while, so the tissue that no tool touches is
// at rest.
static bool furnish(classroom *room, const bench_options *options, const cau_scene_def *scene)
{
	for (int32_t i = 0; i < room->count; i++) {
		room->desks[i].session = seat(scene, i ? room->desks[0].session : NULL);
		if (!room->desks[i].session)
			return false;
		if (i == 0) {
			for (int32_t tick = 0; tick < SETTLE_TICKS; tick++)
				cau_session_step(room->desks[0].session, NULL);
			room->first_bytes = proportional_bytes();
		}
		room->desks[i].driven = i < options->driven;
		fprintf(stderr, "\r%d of %d sessions%s", i + 1, room->count,
		        i + 1 < room->count ? "" : "\n");
	}
	return true;
}

static int teach(classroom *room, const bench_options *options, bench_classroom_result *result)
{
	double begin_s = bench_now_s() + 0.1, warm_s = begin_s + WARM_UP_TICKS * room->step_s;
	for (int32_t i = 0; i < room->count; i++)
		room->desks[i].first_due_s = begin_s + room->step_s * i / room->count;
	if (work_until(room, options->workers, warm_s))
		return 1;
	for (int32_t i = 0; i < room->count; i++)
		room->desks[i].counted = room->desks[i].ticks;
	double start_s = bench_now_s(), cpu_s = bench_cpu_s();
	if (work_until(room, options->workers, warm_s + options->steps * room->step_s))
		return 1;
	double took_s = bench_now_s() - start_s;
	result->cores = (bench_cpu_s() - cpu_s) / took_s;
	if (room->count > 1)
		result->bytes_session_further =
			(proportional_bytes() - room->first_bytes) / (room->count - 1);
	result->realtime_factor_min = INFINITY;
	for (int32_t i = 0; i < room->count; i++) {
		const desk *d = &room->desks[i];
		double made_s = (double)(d->ticks - d->counted) * room->step_s;
		result->realtime_factor_min = fmin(result->realtime_factor_min, made_s / took_s);
		result->elements_removed += d->session->dissection.elements_removed;
		if (d->failed)
			return 1;
	}
	return 0;
}

int bench_classroom(const bench_options *options, bench_classroom_result *result)
{
	*result = (bench_classroom_result){0};
	cau_scene_def *scene = bench_scene_as_it_is(options);
	if (!scene)
		return 1;
	int failed = 1;
	classroom room = {.cut = &scene->cut,
	                  .step_s = scene->step_s,
	                  .count = options->sessions,
	                  .desks = calloc((size_t)options->sessions, sizeof(desk))};
	pthread_mutex_init(&room.mutex, NULL);
	if (!scene->cut.present)
		fprintf(stderr, "cautery-bench: %s has no cut to drive a tool along\n", options->scene);
	else if (room.desks && furnish(&room, options, scene))
		failed = teach(&room, options, result);
	for (int32_t i = 0; room.desks && i < room.count; i++)
		cau_session_destroy(room.desks[i].session);
	pthread_mutex_destroy(&room.mutex);
	free(room.desks);
	free(scene);
	return failed;
}
