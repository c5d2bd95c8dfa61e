// SPDX-License-Identifier: GPL-3.0-or-later
// The cutting run. The scene's tool dwells with energy on and is then moved across at the scene's
// speed, for as many steps as needed. Cutting steps are the steps that removed an element, and
// those with a pending downdate before or after them. Repeated runs have the same bits. So the
// smallest time of a step over the runs is nearest to the step's own cost. Longer times come from
// other load on the machine.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "core/rig/step_error.h"
#include "session/session_internal.h"

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

// Returns the number of ticks that the scene's cut takes from end to end.
static int32_t ticks_across(const cut_run *run)
{
	const cau_cut_def *cut = &run->scene->cut;
	double squared = 0;
	for (int c = 0; c < 3; ++c)
		squared += (cut->to_m[c] - cut->from_m[c]) * (cut->to_m[c] - cut->from_m[c]);
	return (int32_t)ceil(sqrt(squared) / (cut->speed_m_s * run->step_s));
}

// Times of the steps, ms. Each is the smallest time of this step in the runs so far.
typedef struct cut_times {
	double plain[PLAIN_STEPS], *drawn;
	uint8_t *cuts; // true for a drawn step that is a cutting step
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

// Performs the cut in a new session.
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

// ---- errors during the cut

// Number of steps from one sample to the next. A sample is expensive, because its converged step
// takes some hundred iterations.
enum { SAMPLE_EVERY = 24 };

typedef struct along_run {
	cut_run cut;
	cau_session *exact;
	double accuracy, *reported, *found, *ms;
	int64_t iterations;
	int32_t optimistic, above;
} along_run;

static int step_along(along_run *run, int32_t at, bench_along_result *result)
{
	bool sampled = at % SAMPLE_EVERY == 0;
	cau_session *session = run->cut.session;
	cau_frame frame;
	double ms;
	if (sampled) {
		bench_copy_state(run->exact, session);
		bench_keep_awake(run->exact);
		if (cau_session_step(run->exact, NULL))
			return 1;
	}
	double before = bench_cpu_s();
	if (step(&run->cut, &ms, &frame))
		return 1;
	run->ms[at] = 1e3 * (bench_cpu_s() - before);
	double reported = run->reported[at] = session->solver.accuracy.error;
	run->iterations += session->solver.result.iterations;
	run->above += reported > run->accuracy;
	result->elements_removed = frame.statistics.elements_removed;
	if (!sampled)
		return 0;
	double is = step_error(session, run->exact->vertices.position, run->accuracy);
	run->found[result->sampled++] = is;
	run->optimistic += is > 3 * reported;
	return 0;
}

static void sum_up_along(along_run *run, bench_along_result *result)
{
	int32_t n = result->steps;
	result->above = (double)run->above / n;
	result->optimistic = (double)run->optimistic / result->sampled;
	result->iterations_mean = (double)run->iterations / n;
	result->reported_p50 = bench_quantile(run->reported, n, 0.5);
	result->reported_p95 = bench_quantile(run->reported, n, 0.95);
	result->true_p50 = bench_quantile(run->found, result->sampled, 0.5);
	result->true_p95 = bench_quantile(run->found, result->sampled, 0.95);
	result->true_most = bench_quantile(run->found, result->sampled, 1);
	result->ms_median = bench_quantile(run->ms, n, 0.5);
	result->ms_p99 = bench_quantile(run->ms, n, 0.99);
}

// Takes PLAIN_STEPS plain steps, dwells with energy on, and moves the tool across. Then takes
// PLAIN_STEPS more steps, in which the wound settles.
static int draw_along(along_run *run, const cau_scene_def *scene, bench_along_result *result)
{
	int32_t dwell = (int32_t)(scene->cut.dwell_s / run->cut.step_s);
	int32_t across = ticks_across(&run->cut), n = dwell + across + 2 * PLAIN_STEPS;
	run->reported = calloc((size_t)n, sizeof *run->reported);
	run->found = calloc((size_t)n / SAMPLE_EVERY + 1, sizeof *run->found);
	run->ms = calloc((size_t)n, sizeof *run->ms);
	int failed = !run->reported || !run->found || !run->ms;
	for (int32_t i = 0; i < n && !failed; i++) {
		if (i == PLAIN_STEPS)
			energize(&run->cut);
		if (i == 0)
			move_to(&run->cut, 0);
		else if (i > PLAIN_STEPS + dwell && i <= PLAIN_STEPS + dwell + across)
			move_to(&run->cut, (double)(i - PLAIN_STEPS - dwell) / across);
		failed = step_along(run, i, result);
	}
	result->steps = n;
	if (!failed)
		sum_up_along(run, result);
	free(run->reported);
	free(run->found);
	free(run->ms);
	return failed;
}

int bench_along(const bench_options *options, bench_along_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene_as_it_is(options);
	if (!scene)
		return 1;
	scene->accuracy = options->accuracy;
	along_run run = {.cut = {bench_session(scene, options, options->threads), scene, scene->step_s},
	                 .exact = bench_session(scene, options, options->threads),
	                 .accuracy = options->accuracy};
	int failed = !run.cut.session || !run.exact || !scene->cut.present;
	if (!failed) {
		bench_converge(run.exact);
		failed = draw_along(&run, scene, result);
	}
	cau_session_destroy(run.cut.session);
	cau_session_destroy(run.exact);
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
