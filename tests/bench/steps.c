// SPDX-License-Identifier: GPL-3.0-or-later
// Plain steps with heat and contact. One tool has energy on a hand's breadth above the tissue, so
// that heat flows in its grid. Another tool is cold and presses a millimetre into the tissue.
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "bench/bench.h"
#include "session/session_internal.h"

enum { WARM_UP = 60, MOST_STEPS = 100000, CHOLMOD_RUNS = 60 };
static const double press_m = 1e-3, hot_height_m = 0.03;

static cau_command move_command(const char *tool, const double at[3])
{
	cau_command command;
	memset(&command, 0, sizeof command);
	command.kind = CAU_COMMAND_TOOL_MOVE;
	snprintf(command.tool, sizeof command.tool, "%s", tool);
	memcpy(command.as.move.pose.position_m, at, 3 * sizeof(double));
	command.as.move.pose.rotation[0] = 1;
	return command;
}

// Finds the highest vertex near the middle of the scene.
static void top_middle(const cau_session *session, double at[3])
{
	double best = -1e300;
	for (int32_t v = 0; v < session->tissue.vertex_count; ++v) {
		const double *x = session->vertices.position + 3 * (size_t)v;
		double value = x[2] - 10 * (x[0] * x[0] + x[1] * x[1]);
		if (!session->vertices.fixed[v] && value > best) {
			best = value;
			memcpy(at, x, 3 * sizeof(double));
		}
	}
}

void bench_place_tools(cau_session *session)
{
	double at[3] = {0, 0, 0};
	top_middle(session, at);
	cau_command add;
	memset(&add, 0, sizeof add);
	add.kind = CAU_COMMAND_TOOL_ADD;
	cau_default_tool_def(&add.as.definition, CAU_TOOL_SPHERE);
	snprintf(add.as.definition.name, sizeof add.as.definition.name, "press");
	double radius = add.as.definition.hot_radius_m,
		   press[3] = {at[0], at[1], at[2] + radius - press_m};
	memcpy(add.as.definition.pose.position_m, press, sizeof press);
	bench_submit(session, &add);
	cau_tool_def *def = &add.as.definition;
	snprintf(def->name, sizeof def->name, "heat");
	def->pose.position_m[2] = at[2] + hot_height_m;
	bench_submit(session, &add);
	cau_command energize;
	memset(&energize, 0, sizeof energize);
	energize.kind = CAU_COMMAND_TOOL_ENERGIZE;
	snprintf(energize.tool, sizeof energize.tool, "heat");
	energize.as.energized = 1;
	bench_submit(session, &energize);
	cau_command move = move_command("press", press);
	bench_submit(session, &move);
}

// Returns the median time, ms, of a three-column solve by CHOLMOD with the same matrix on one
// thread.
static double time_cholmod(cau_session *session)
{
	cau_step_solver *solver = &session->solver;
	if (!solver->factor)
		return 0;
	size_t n = 3 * (size_t)solver->system.row_count;
	double *b = malloc(n * sizeof *b), *x = malloc(n * sizeof *x), times[CHOLMOD_RUNS];
	for (size_t i = 0; i < n; ++i)
		b[i] = (double)(i % 17) - 8;
	for (int r = 0; r < CHOLMOD_RUNS; ++r) {
		double start = bench_now_s();
		cau_factor_solve(solver->factor, b, x, NULL);
		times[r] = 1e3 * (bench_now_s() - start);
	}
	free(b);
	free(x);
	return bench_quantile(times, CHOLMOD_RUNS, 0.5);
}

static int run(cau_session *session, const bench_options *options, bench_steps_result *result)
{
	double *ms = calloc((size_t)options->steps, sizeof *ms);
	double *stage[CAU_STAGE_COUNT];
	for (int s = 0; s < CAU_STAGE_COUNT; ++s)
		stage[s] = calloc((size_t)options->steps, sizeof **stage);
	cau_error error = {0};
	cau_frame frame;
	int failed = 0;
	uint64_t before = 0;
	for (int32_t i = -WARM_UP; i < options->steps && !failed; ++i) {
		if (i == 0)
			before = bench_allocations();
		double start = bench_now_s();
		failed = cau_session_step(session, &error) != CAU_OK;
		double took = 1e3 * (bench_now_s() - start);
		if (i < 0 || failed)
			continue;
		ms[i] = took;
		cau_session_frame(session, &frame);
		for (int s = 0; s < CAU_STAGE_COUNT; ++s)
			stage[s][i] = 1e3 * frame.statistics.seconds[s];
		result->contacts = frame.statistics.contacts;
	}
	result->allocations_per_step = (double)(bench_allocations() - before) / options->steps;
	double sum = 0;
	for (int32_t i = 0; i < options->steps; ++i)
		sum += ms[i];
	result->timing.steps_per_s = 1e3 * options->steps / sum;
	result->timing.median_ms = bench_quantile(ms, options->steps, 0.5);
	result->timing.p99_ms = bench_quantile(ms, options->steps, 0.99);
	for (int s = 0; s < CAU_STAGE_COUNT; ++s) {
		result->timing.stage_ms[s] = bench_quantile(stage[s], options->steps, 0.5);
		free(stage[s]);
	}
	free(ms);
	if (failed)
		fprintf(stderr, "cautery-bench: %s\n", error.reason);
	return failed;
}

int bench_steps(const bench_options *options, bench_steps_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	if (!scene)
		return 1;
	struct mallinfo2 heap_before = mallinfo2();
	size_t pages_before = cau_pages_held();
	cau_session *session = bench_session(scene, options, options->threads);
	struct mallinfo2 heap_after = mallinfo2();
	free(scene);
	if (!session)
		return 1;
	result->bytes_session = (double)(heap_after.uordblks + heap_after.hblkhd) -
	                        (double)(heap_before.uordblks + heap_before.hblkhd) +
	                        (double)(cau_pages_held() - pages_before);
	result->vertices = session->tissue.vertex_count;
	result->tetrahedra = session->tissue.tetrahedron_count;
	result->triangles = session->tissue.triangle_count;
	cau_session_set_clock(session, bench_now_s);
	bench_place_tools(session);
	int failed = run(session, options, result);
	result->cholmod_ms = time_cholmod(session);
	if (result->cholmod_ms > 0)
		result->frame_over_cholmod =
			result->timing.median_ms / (options->iterations * result->cholmod_ms);
	result->hash = cau_session_hash(session);
	snprintf(result->instruction_set, sizeof result->instruction_set, "%s",
	         session->solver.kernels->instruction_set);
	cau_session_destroy(session);
	return failed;
}
