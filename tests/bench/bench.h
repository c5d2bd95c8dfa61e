// SPDX-License-Identifier: GPL-3.0-or-later
// cautery-bench: the measurements and their results (see the folder's README).
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "cautery/session.h"

typedef struct bench_options {
	const char *scene, *scenes_directory;
	int32_t threads, iterations, steps, repeat;
	int solver, precision; // -1: the solver and precision of the scene
	double accuracy;       // wanted accuracy; 0: accuracy is not measured
	bool cut, error, scaling, rest, update, remesh, classroom, json, help;
	// numbers of sessions, driven sessions and workers of a classroom
	int32_t sessions, driven, workers;
	const char *instruction_set;
} bench_options;

// options.c: reads the command line. Prints a mistake on `complaints` and returns false.
bool bench_options_read(int argument_count, char **arguments, bench_options *options,
                        FILE *complaints);
void bench_options_help(FILE *out);

typedef struct bench_timing {
	double median_ms, p99_ms, steps_per_s;
	double stage_ms[CAU_STAGE_COUNT]; // medians of the stages
} bench_timing;

double bench_now_s(void);
double bench_cpu_s(void); // processor time of all threads
// Sorts `count` values and returns the given quantile.
double bench_quantile(double *values, int32_t count, double quantile);

// Reads a scene by name or path and applies the options. Prints an error on standard error and
// returns NULL if that fails.
cau_scene_def *bench_scene(const bench_options *options);
// Reads a scene as bench_scene does, but keeps its accuracy, iterations, solver and precision.
cau_scene_def *bench_scene_as_it_is(const bench_options *options);
cau_session *bench_session(const cau_scene_def *scene, const bench_options *options,
                           int32_t threads);
void bench_submit(cau_session *session, const cau_command *command);
// Makes the next step compute resting tissue, too: sets gravity to its present value.
void bench_keep_awake(cau_session *session);

// steps.c: plain steps with heat and contact. Returns 0, or 1 after an error message.
typedef struct bench_steps_result {
	bench_timing timing;
	double frame_over_cholmod, cholmod_ms, allocations_per_step, bytes_session;
	int32_t vertices, tetrahedra, triangles, contacts;
	uint64_t hash;
	char instruction_set[16]; // instruction set that the session used
} bench_steps_result;
int bench_steps(const bench_options *options, bench_steps_result *result);

// cut.c: the scene's tool is moved across the tissue with energy on.
typedef struct bench_cut_result {
	double plain_median_ms, plain_p99_ms, cut_p99_ms, cut_p99_over_plain, deferred_max_s;
	int32_t elements_removed, cutting_steps, refactorisations;
} bench_cut_result;
int bench_cut(const bench_options *options, bench_cut_result *result);
// cut.c: the errors of the steps of a cut: the session's reported errors and the true errors.
typedef struct bench_along_result {
	int32_t steps, sampled; // sampled: steps that were repeated until they converged
	double above;           // share of the steps whose reported error is above the accuracy
	double reported_p50, reported_p95;    // over all steps
	double true_p50, true_p95, true_most; // over sampled steps
	double optimistic; // share of sampled steps with a true error above 3 x the reported error
	// means and quantiles over all steps; processor time of all threads
	double iterations_mean, ms_median, ms_p99;
	int32_t elements_removed;
} bench_along_result;
int bench_along(const bench_options *options, bench_along_result *result);

// error.c: the error of K iterations relative to the converged step, under the scene's pull.
enum { BENCH_CURVE = 9 };
typedef struct bench_error_result {
	double error_at_k, error_max, ms_to_1pct;
	double reference_residual; // largest residual of the converged steps
	int32_t iterations_to_1pct;
	// mean error and median time of steps with this number of iterations
	int32_t curve_iterations[BENCH_CURVE];
	double curve_error[BENCH_CURVE], curve_ms[BENCH_CURVE];
} bench_error_result;
int bench_error(const bench_options *options, bench_error_result *result);

// accuracy.c: steps that end at an accuracy, alternating with steps of K iterations.
typedef struct bench_accuracy_result {
	double speedup_over_k; // time of K iterations over the time with the accuracy
	// error of sampled steps: the larger of the errors of the whole and of each chunk
	double error_p95;
	double iterations_mean; // mean number of iterations of a step
	double rest_core_share; // share of one core that a resting session takes
} bench_accuracy_result;
int bench_accuracy(const bench_options *options, bench_accuracy_result *result);
// Copies the state of `from` to `to`, a session of the same scene.
void bench_copy_state(cau_session *to, const cau_session *from);
// Makes the session's steps iterate until they converge.
void bench_converge(cau_session *session);

// classroom.c: many sessions in real time, some of them driven, on a few workers.
typedef struct bench_classroom_result {
	double realtime_factor_min;   // simulated over wall time, of the slowest session
	double bytes_session_further; // memory for each session after the first
	double cores;                 // number of busy cores
	int32_t elements_removed;     // elements that all tools removed
} bench_classroom_result;
int bench_classroom(const bench_options *options, bench_classroom_result *result);
// steps.c: places the tools of plain steps. One tool is above the tissue with energy on, the other
// tool is pressed into the tissue.
void bench_place_tools(cau_session *session);

// limit.c: the time of a step if it only had to move its bytes through one core.
typedef struct bench_limit_result {
	double bytes_step;    // bytes that K iterations read and write, with each array once a pass
	double bandwidth_b_s; // rate at which one core reads a block of one iteration's size repeatedly
	double limit_ms;      // least time of a step: bytes_step / bandwidth_b_s / threads
} bench_limit_result;
int bench_limit(const bench_options *options, bench_limit_result *result);

// scaling.c: step time over size. The slab grows in its plane.
typedef struct bench_scaling_result {
	int32_t count;
	int32_t tetrahedra[4];
	double ms[4];
	double exponent;
} bench_scaling_result;
int bench_scaling(const bench_options *options, bench_scaling_result *result);

// update.c: updates of the matrix after cuts of `elements` elements.
enum { BENCH_UPDATES = 5 };
typedef struct bench_update_row {
	int32_t elements;
	double downdate_ms, refactor_ms, anew_ms; // anew_ms: with ordering and analysis
} bench_update_row;
typedef struct bench_update_result {
	int32_t vertices;
	bench_update_row row[BENCH_UPDATES];
} bench_update_result;
int bench_update(const bench_options *options, bench_update_result *result);

// remesh.c: the scene's cut by a method that changes the topology, and by Cautery's method.
typedef struct bench_remesh_result {
	int32_t vertices, elements; // sizes before the cut
	// the method that changes the topology
	int32_t changes; // ticks in which the mesh and the data that depend on it changed
	int32_t vertices_added, elements_added, ill_shaped;
	// entries added to and removed from the lists of elements around vertices
	int64_t inserts, deletes;
	double remesh_s, assemble_s, factor_s;
	double buffer_bytes; // size of the vertex and index buffers that are written at all changes
	double system_bytes; // size of A and its factor that are computed at all changes
	// Cautery's method
	int32_t our_changes; // ticks in which faces became hidden or the factor changed
	int32_t edges_parted, elements_removed, refactorisations;
	double our_mask_bytes; // size of the changed words of the mask
	double our_s; // time for edge shares, mask, downdates and waiting for the factor, in all ticks
} bench_remesh_result;
int bench_remesh(const bench_options *options, bench_remesh_result *result);
// cut.c: the cut by Cautery's method, in a session without cuts.
int bench_cut_ours(cau_session *session, const cau_scene_def *scene, bench_remesh_result *result);

// allocation.c: number of calls of malloc, calloc, realloc and aligned_alloc so far.
uint64_t bench_allocations(void);
