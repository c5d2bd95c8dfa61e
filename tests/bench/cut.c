// SPDX-License-Identifier: GPL-3.0-or-later
// The cutting run: the scene's tool dwells, then is drawn across at the scene's speed with its
// energy on, however many steps that takes. Cutting steps are those that removed an element, and
// those before or after which one was to be taken out of the factor. Repeated runs are the same to
// the last bit: the least time of a step is nearest to its own cost, the rest is what the machine
// did beside it.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"

enum { PLAIN_STEPS = 120 };

typedef struct cut_run {
	cau_session *session;
	const cau_scene_def *scene;
	double step_s;
} cut_run;

static void move_to(const cut_run *run, double share)
{
	const cau_cut_def *cut = &run->scene->cut;
	cau_command command;
	memset(&command, 0, sizeof command);
	command.kind = CAU_COMMAND_TOOL_MOVE;
	memcpy(command.tool, cut->tool, sizeof command.tool);
	for (int c = 0; c < 3; ++c)
		command.as.move.pose.position_m[c] =
			cut->from_m[c] + share * (cut->to_m[c] - cut->from_m[c]);
	memcpy(command.as.move.pose.rotation, cut->rotation, sizeof cut->rotation);
	bench_submit(run->session, &command);
}

static void energize(const cut_run *run)
{
	cau_command command;
	memset(&command, 0, sizeof command);
	command.kind = CAU_COMMAND_TOOL_ENERGIZE;
	memcpy(command.tool, run->scene->cut.tool, sizeof command.tool);
	command.as.energized = 1;
	bench_submit(run->session, &command);
}

static int step(const cut_run *run, double *ms, cau_frame *frame)
{
	cau_error error = {0};
	bench_keep_awake(run->session);
	double start = bench_now_s();
	cau_status status = cau_session_step(run->session, &error);
	*ms = 1e3 * (bench_now_s() - start);
	cau_session_frame(run->session, frame);
	if (status)
		fprintf(stderr, "cautery-bench: %s\n", error.reason);
	return status != CAU_OK;
}

// Ticks that the scene's cut takes from end to end.
static int32_t ticks_across(const cut_run *run)
{
	const cau_cut_def *cut = &run->scene->cut;
	double squared = 0;
	for (int c = 0; c < 3; ++c)
		squared += (cut->to_m[c] - cut->from_m[c]) * (cut->to_m[c] - cut->from_m[c]);
	return (int32_t)ceil(sqrt(squared) / (cut->speed_m_s * run->step_s));
}

// Times of one step each, the least of the runs so far.
typedef struct cut_times {
	double plain[PLAIN_STEPS], *drawn;
	uint8_t *cuts; // of the drawn steps: whether it is a cutting one
	int32_t drawn_count;
} cut_times;

static void keep_least(double *least, double ms)
{
	if (*least == 0 || ms < *least)
		*least = ms;
}

static int draw(const cut_run *run, cut_times *times, bench_cut_result *result)
{
	double ms;
	cau_frame frame;
	int failed = 0;
	move_to(run, 0);
	for (int i = 0; i < PLAIN_STEPS && !failed; ++i) {
		failed = step(run, &ms, &frame);
		keep_least(&times->plain[i], ms);
	}
	energize(run);
	int32_t dwell = (int32_t)(run->scene->cut.dwell_s / run->step_s), removed = 0, waiting = 0;
	for (int32_t i = -dwell; i < times->drawn_count && !failed; ++i) {
		if (i >= 0)
			move_to(run, (double)i / times->drawn_count);
		failed = step(run, &ms, &frame);
		if (i >= 0) {
			keep_least(&times->drawn[i], ms);
			times->cuts[i] = frame.statistics.elements_removed > removed || waiting > 0 ||
			                 frame.statistics.pending_downdates > 0;
		}
		removed = frame.statistics.elements_removed;
		waiting = frame.statistics.pending_downdates;
	}
	result->elements_removed = removed;
	result->deferred_max_s = frame.statistics.deferred_max_s;
	result->refactorisations = frame.statistics.refactorisations;
	return failed;
}

static void sum_up(cut_times *times, bench_cut_result *result)
{
	for (int32_t i = 0; i < times->drawn_count; ++i)
		if (times->cuts[i])
			times->drawn[result->cutting_steps++] = times->drawn[i];
	result->plain_median_ms = bench_quantile(times->plain, PLAIN_STEPS, 0.5);
	result->plain_p99_ms = bench_quantile(times->plain, PLAIN_STEPS, 0.99);
	result->cut_p99_ms = bench_quantile(times->drawn, result->cutting_steps, 0.99);
	result->cut_p99_over_plain =
		result->plain_median_ms > 0 ? result->cut_p99_ms / result->plain_median_ms : 0;
}

// The cut on a fresh session.
static int run_once(const bench_options *options, const cau_scene_def *scene, cut_times *times,
                    bench_cut_result *result)
{
	cau_session *session = bench_session(scene, options, options->threads);
	if (!session)
		return 1;
	int failed = draw(&(cut_run){session, scene, scene->step_s}, times, result);
	cau_session_destroy(session);
	return failed;
}

int bench_cut(const bench_options *options, bench_cut_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	if (!scene)
		return 1;
	if (!scene->cut.present) {
		fprintf(stderr, "cautery-bench: scene %s has no cut\n", options->scene);
		free(scene);
		return 1;
	}
	cut_times times = {.drawn_count = ticks_across(&(cut_run){NULL, scene, scene->step_s})};
	times.drawn = calloc((size_t)times.drawn_count, sizeof *times.drawn);
	times.cuts = calloc((size_t)times.drawn_count, sizeof *times.cuts);
	int failed = !times.drawn || !times.cuts;
	for (int32_t r = 0; r < options->repeat && !failed; ++r)
		failed = run_once(options, scene, &times, result);
	if (!failed)
		sum_up(&times, result);
	free(times.drawn);
	free(times.cuts);
	free(scene);
	return failed;
}

int bench_cut_ours(cau_session *session, const cau_scene_def *scene, bench_remesh_result *result)
{
	cut_run run = {session, scene, scene->step_s};
	int32_t dwell = (int32_t)(scene->cut.dwell_s / run.step_s), across = ticks_across(&run);
	int failed = 0;
	double ms;
	cau_frame frame;
	cau_session_set_clock(session, bench_now_s);
	move_to(&run, 0);
	for (int32_t i = 0; i < PLAIN_STEPS && !failed; i++)
		failed = step(&run, &ms, &frame);
	energize(&run);
	for (int32_t i = -dwell; i <= across && !failed; i++) {
		int32_t waiting = frame.statistics.pending_downdates;
		move_to(&run, fmax(0, (double)i / across));
		failed = step(&run, &ms, &frame);
		result->our_s += frame.statistics.seconds[CAU_STAGE_DISSECT];
		result->our_mask_bytes += 4.0 * frame.mask_changed_count;
		result->our_changes += frame.mask_changed_count > 0 || waiting > 0;
	}
	result->edges_parted = frame.statistics.edges_parted;
	result->elements_removed = frame.statistics.elements_removed;
	result->refactorisations = frame.statistics.refactorisations;
	return failed;
}
