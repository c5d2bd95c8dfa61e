// SPDX-License-Identifier: GPL-3.0-or-later
// Compares steps that end at an accuracy with steps of K iterations. Two sessions of one scene are
// stepped alternately, so that other load on the machine slows both. A third session repeats
// sampled steps from the same state and iterates until they converge.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "core/rig/step_error.h"
#include "session/session_internal.h"

enum {
	WARM_UP = 60,
	MOST = 40, // largest number of iterations of a step with an accuracy
	SAMPLES = 20,
	REST_TICKS = 3000, // longest wait until the tissue rests
	RESTING_TICKS = 100000,
};

typedef struct turns {
	cau_session *session, *fixed, *exact;
	double accuracy;
} turns;

void bench_copy_state(cau_session *to, const cau_session *from)
{
	size_t bytes = cau_session_snapshot_bytes(from), used = 0;
	void *shot = malloc(bytes);
	cau_error error = {0};
	if (!shot || cau_session_snapshot(from, shot, bytes, &used, &error) ||
	    cau_session_restore(to, shot, used, NULL, &error)) {
		fprintf(stderr, "cautery-bench: %s\n", error.reason);
		exit(1);
	}
	free(shot);
}

void bench_converge(cau_session *session)
{
	session->solver.accuracy.wanted = 0;
	session->solver.settings.iterations = 300;
	session->solver.settings.tolerance = 3e-7;
}

static double step_s(cau_session *session)
{
	cau_error error = {0};
	bench_keep_awake(session);
	double start = bench_now_s();
	if (cau_session_step(session, &error)) {
		fprintf(stderr, "cautery-bench: %s\n", error.reason);
		exit(1);
	}
	return bench_now_s() - start;
}

static void measure(turns *t, int32_t steps, bench_accuracy_result *result)
{
	double accurate_s = 0, fixed_s = 0, error[SAMPLES] = {0};
	int64_t iterations = 0;
	int32_t samples = 0, every = steps / SAMPLES > 0 ? steps / SAMPLES : 1;
	for (int32_t i = -WARM_UP; i < steps; i++) {
		bool sampled = t->exact && i >= 0 && i % every == 0 && samples < SAMPLES;
		if (sampled) {
			bench_copy_state(t->exact, t->session);
			step_s(t->exact);
		}
		double accurate = step_s(t->session), fixed = step_s(t->fixed);
		if (sampled)
			error[samples++] = step_error(t->session, t->exact->vertices.position, t->accuracy);
		if (i < 0)
			continue;
		accurate_s += accurate;
		fixed_s += fixed;
		iterations += t->session->solver.result.iterations;
	}
	result->speedup_over_k = fixed_s / accurate_s;
	result->iterations_mean = (double)iterations / steps;
	result->error_p95 = bench_quantile(error, samples, 0.95);
}

// Steps a session without commands until it rests. Then measures the share of one core that resting
// steps take.
static int measure_rest(turns *t, bench_accuracy_result *result)
{
	int32_t ticks = 0;
	for (; !t->session->rest.resting && ticks < REST_TICKS; ticks++)
		cau_session_step(t->session, NULL);
	if (!t->session->rest.resting) {
		fprintf(stderr, "cautery-bench: no rest after %d ticks\n", ticks);
		return 1;
	}
	double start = bench_now_s();
	for (int32_t i = 0; i < RESTING_TICKS; i++)
		cau_session_step(t->session, NULL);
	result->rest_core_share = (bench_now_s() - start) / (RESTING_TICKS * t->session->solver.step_s);
	// After the copy, both sessions are awake and start from rest.
	bench_copy_state(t->fixed, t->session);
	return 0;
}

static int measure_scene(turns *t, const bench_options *options, bench_accuracy_result *result)
{
	if (!t->session || !t->fixed || (!options->rest && !t->exact))
		return 1;
	if (options->rest && measure_rest(t, result))
		return 1;
	if (!options->rest) {
		bench_place_tools(t->session);
		bench_place_tools(t->fixed);
	}
	measure(t, options->steps, result);
	return 0;
}

int bench_accuracy(const bench_options *options, bench_accuracy_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	if (!scene)
		return 1;
	turns t = {.accuracy = options->accuracy > 0 ? options->accuracy : 0.01};
	scene->accuracy = t.accuracy;
	scene->iterations = options->iterations > MOST ? options->iterations : MOST;
	t.session = bench_session(scene, options, options->threads);
	t.fixed = bench_session(scene, options, options->threads);
	if (!options->rest)
		t.exact = bench_session(scene, options, options->threads);
	if (t.fixed) {
		t.fixed->solver.accuracy.wanted = 0;
		t.fixed->solver.settings.iterations = options->iterations;
	}
	if (t.exact)
		bench_converge(t.exact);
	int failed = measure_scene(&t, options, result);
	cau_session_destroy(t.session);
	cau_session_destroy(t.fixed);
	cau_session_destroy(t.exact);
	free(scene);
	return failed;
}
