// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the error of a step of K iterations under the scene's pull. A session in double
// precision repeats each measured step from the same state and iterates to convergence. The error
// is the distance between both results relative to the step's own motion, over all free vertices,
// in the mass norm.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "session/session_internal.h"

enum {
	CONVERGED_ITERATIONS = 1000,
	// Iterations of a converged step of the diagonal solver, which takes hundreds of iterations to
	// halve the error.
	CONVERGED_DIAGONAL = 10000,
	SAMPLES = 10,
	MOST_SAMPLES = 64
};
static const double converged_residual = 1e-11;
static const int32_t curve_iterations[BENCH_CURVE] = {1, 2, 3, 5, 7, 10, 15, 20, 30};

typedef struct error_curve {
	int32_t count;
	double error[BENCH_CURVE], ms[BENCH_CURVE][MOST_SAMPLES];
} error_curve;

typedef struct pull_run {
	const cau_scene_def *scene;
	int32_t count, *vertex;
	double *start, *position;
} pull_run;

static cau_session *pinned_session(const cau_scene_def *scene, const bench_options *options)
{
	cau_session *session = bench_session(scene, options, options->threads);
	if (!session)
		return NULL;
	cau_command pin;
	memset(&pin, 0, sizeof pin);
	pin.kind = CAU_COMMAND_PIN;
	pin.as.selection = scene->pull.selection;
	bench_submit(session, &pin);
	cau_error error = {0};
	if (cau_session_step(session, &error)) {
		fprintf(stderr, "cautery-bench: %s\n", error.reason);
		cau_session_destroy(session);
		return NULL;
	}
	return session;
}

static void choose(pull_run *pull, cau_session *session)
{
	int32_t n = session->tissue.vertex_count;
	pull->vertex = calloc((size_t)n, sizeof *pull->vertex);
	pull->start = calloc(3 * (size_t)n, sizeof *pull->start);
	pull->position = calloc(3 * (size_t)n, sizeof *pull->position);
	memset(session->vertices.chosen, 0, (size_t)n);
	cau_tissue_select(&session->tissue, &pull->scene->pull.selection, session->vertices.chosen);
	for (int32_t v = 0; v < n; ++v)
		if (session->vertices.chosen[v]) {
			memcpy(pull->start + 3 * (size_t)pull->count,
			       session->vertices.position + 3 * (size_t)v, 3 * sizeof(double));
			pull->vertex[pull->count++] = v;
		}
}

static void drive(pull_run *pull, cau_session *session, double share)
{
	for (int32_t k = 0; k < pull->count; ++k)
		for (int c = 0; c < 3; ++c)
			pull->position[3 * k + c] =
				pull->start[3 * k + c] + share * pull->scene->pull.move_m[c];
	cau_error error = {0};
	if (cau_session_drive(session, pull->count, pull->vertex, pull->position, &error)) {
		fprintf(stderr, "cautery-bench: %s\n", error.reason);
		exit(1);
	}
}

static void copy_reals(void *to, int to_single, const void *from, int from_single, int32_t count)
{
	for (int32_t i = 0; i < count; ++i)
		cau_real_set(to, to_single, i, cau_real_get(from, from_single, i));
}

// Copies the state of one session to another, which may have another precision.
static void copy_state(cau_session *to, const cau_session *from)
{
	size_t bytes = 3 * (size_t)from->tissue.vertex_count * sizeof(double);
	memcpy(to->vertices.position, from->vertices.position, bytes);
	memcpy(to->vertices.velocity, from->vertices.velocity, bytes);
	const cau_fat_set *a = &from->solver.elements.fat;
	cau_fat_set *b = &to->solver.elements.fat;
	int one = from->solver.elements.single, two = to->solver.elements.single;
	for (int i = 0; i < 6; ++i) {
		copy_reals(b->plastic[i], two, a->plastic[i], one, a->slot_count);
		copy_reals(b->plastic_strain[i], two, a->plastic_strain[i], one, a->slot_count);
	}
	memcpy(b->flowed, a->flowed, (size_t)(a->slot_count / CAU_BATCH));
	for (int i = 0; i < 4; ++i)
		copy_reals(b->polar[i], two, a->polar[i], one, a->slot_count);
}

static double mass_distance(const cau_session *session, const double *a, const double *b)
{
	double sum = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; ++v)
		for (int c = 0; c < 3 && !session->vertices.fixed[v]; ++c) {
			double d = a[3 * v + c] - b[3 * v + c];
			sum += session->tissue.mass[v] * d * d;
		}
	return sqrt(sum);
}

// Returns the error of one step of `iterations` from the state of `state`. `exact` has the
// converged result.
static double step_error(pull_run *pull, cau_session *trial, const cau_session *state,
                         const cau_session *exact, double share, int32_t iterations, double *ms)
{
	copy_state(trial, state);
	trial->solver.settings.iterations = iterations;
	drive(pull, trial, share);
	double start = bench_now_s();
	cau_session_step(trial, NULL);
	*ms = 1e3 * (bench_now_s() - start);
	double moved = mass_distance(exact, exact->vertices.position, exact->vertices.start);
	return moved > 0
	           ? mass_distance(exact, trial->vertices.position, exact->vertices.position) / moved
	           : 0;
}

// Adds one sample of error over time: steps with several numbers of iterations from one state.
static void sample_curve(pull_run *pull, cau_session *trial, const cau_session *state,
                         const cau_session *exact, double share, error_curve *curve)
{
	for (int i = 0; i < BENCH_CURVE && curve->count < MOST_SAMPLES; ++i)
		curve->error[i] += step_error(pull, trial, state, exact, share, curve_iterations[i],
		                              &curve->ms[i][curve->count]);
	curve->count++;
}

static void finish_curve(error_curve *curve, bench_error_result *result)
{
	for (int i = 0; i < BENCH_CURVE; ++i) {
		result->curve_iterations[i] = curve_iterations[i];
		result->curve_error[i] = curve->error[i] / fmax(curve->count, 1);
		result->curve_ms[i] = bench_quantile(curve->ms[i], curve->count, 0.5);
	}
}

static void measure(const bench_options *options, pull_run *pull, cau_session *state,
                    cau_session *trial, cau_session *exact, bench_error_result *result)
{
	int32_t ticks = (int32_t)(pull->scene->pull.duration_s / pull->scene->step_s + 0.5);
	int32_t samples = 0, every = ticks / SAMPLES > 0 ? ticks / SAMPLES : 1;
	double sum = 0, first_ms[MOST_SAMPLES] = {0};
	int32_t reach = 0;
	error_curve curve = {0};
	for (int32_t t = 1; t <= ticks; ++t) {
		double share = (double)t / ticks, ms;
		if (t % every == 0) {
			copy_state(exact, state);
			drive(pull, exact, share);
			cau_session_step(exact, NULL);
			result->reference_residual =
				fmax(result->reference_residual, exact->solver.result.residual);
			double error = step_error(pull, trial, state, exact, share, options->iterations, &ms);
			sum += error;
			samples++;
			result->error_max = fmax(result->error_max, error);
			sample_curve(pull, trial, state, exact, share, &curve);
			int32_t k = 1;
			while (k < 64 && step_error(pull, trial, state, exact, share, k, &ms) > 0.01)
				k++;
			first_ms[samples % MOST_SAMPLES] = ms;
			reach = k > reach ? k : reach;
		}
		drive(pull, state, share);
		cau_session_step(state, NULL);
	}
	result->error_at_k = samples ? sum / samples : 0;
	result->iterations_to_1pct = reach;
	result->ms_to_1pct = bench_quantile(first_ms + 1, samples < 63 ? samples : 63, 0.5);
	finish_curve(&curve, result);
}

// Turns tearing off. A trial repeats a step many times from one state, and each repetition would
// count as a tick towards a tear. The trial's tissue would soon differ from the tissue of the
// converged step.
static void tear_nothing(cau_scene_def *scene)
{
	for (int32_t l = 0; l < scene->layer_count; ++l) {
		cau_layer_def *layer = &scene->layers[l];
		for (int m = 0; m < CAU_MAX_MATERIALS; ++m)
			layer->sheet[m].heat.tear_energy_j_m2 = layer->fat[m].heat.tear_energy_j_m2 = 0;
		layer->link.heat.tear_energy_j_m2 = 0;
	}
}

int bench_error(const bench_options *options, bench_error_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	if (!scene)
		return 1;
	tear_nothing(scene);
	int failed = 1;
	pull_run pull = {.scene = scene};
	cau_session *state = NULL, *trial = NULL, *exact = NULL;
	if (!scene->pull.present) {
		fprintf(stderr, "cautery-bench: scene %s has no pull\n", options->scene);
		goto done;
	}
	state = pinned_session(scene, options);
	trial = pinned_session(scene, options);
	scene->precision = CAU_PRECISION_DOUBLE;
	scene->iterations = CONVERGED_ITERATIONS;
	scene->tolerance = converged_residual;
	exact = pinned_session(scene, options);
	if (!state || !trial || !exact)
		goto done;
	if (exact->solver.settings.diagonal)
		exact->solver.settings.iterations = CONVERGED_DIAGONAL;
	choose(&pull, state);
	measure(options, &pull, state, trial, exact, result);
	failed = 0;
done:
	cau_session_destroy(state);
	cau_session_destroy(trial);
	cau_session_destroy(exact);
	free(pull.vertex);
	free(pull.start);
	free(pull.position);
	free(scene);
	return failed;
}
