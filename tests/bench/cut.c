// SPDX-License-Identifier: GPL-3.0-or-later
// The cutting run: the scene's tool dwells, then is drawn across at the scene's speed with its
// energy on, however many steps that takes. Cutting steps are those that removed an element or
// still had one to take out of the factor.
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

static int draw(const cut_run *run, bench_cut_result *result)
{
	int32_t steps = ticks_across(run);
	double plain[PLAIN_STEPS], *cutting = calloc((size_t)steps, sizeof *cutting), ms;
	cau_frame frame;
	int failed = 0;
	move_to(run, 0);
	for (int i = 0; i < PLAIN_STEPS && !failed; ++i)
		failed = step(run, &plain[i], &frame);
	energize(run);
	int32_t dwell = (int32_t)(run->scene->cut.dwell_s / run->step_s), removed = 0;
	for (int32_t i = 0; i < dwell + steps && !failed; ++i) {
		if (i >= dwell)
			move_to(run, (double)(i - dwell) / steps);
		failed = step(run, &ms, &frame);
		int cuts =
			frame.statistics.elements_removed > removed || frame.statistics.pending_downdates;
		if (i >= dwell && cuts && result->cutting_steps < steps)
			cutting[result->cutting_steps++] = ms;
		removed = frame.statistics.elements_removed;
	}
	result->elements_removed = removed;
	result->deferred_max_s = frame.statistics.deferred_max_s;
	result->refactorisations = frame.statistics.refactorisations;
	result->plain_median_ms = bench_quantile(plain, PLAIN_STEPS, 0.5);
	result->cut_p99_ms = bench_quantile(cutting, result->cutting_steps, 0.99);
	result->cut_p99_over_plain =
		result->plain_median_ms > 0 ? result->cut_p99_ms / result->plain_median_ms : 0;
	free(cutting);
	return failed;
}

int bench_cut(const bench_options *options, bench_cut_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	if (!scene)
		return 1;
	int failed = 1;
	if (!scene->cut.present) {
		fprintf(stderr, "cautery-bench: scene %s has no cut\n", options->scene);
		free(scene);
		return 1;
	}
	cau_session *session = bench_session(scene, options, options->threads);
	if (session)
		failed = draw(&(cut_run){session, scene, scene->step_s}, result);
	cau_session_destroy(session);
	free(scene);
	return failed;
}
