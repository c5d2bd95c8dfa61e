// SPDX-License-Identifier: GPL-3.0-or-later
// cautery-bench: what is measured and how (see the folder's README).
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "cautery/session.h"

typedef struct bench_options {
	const char *scene, *scenes_directory;
	int32_t threads, iterations, steps, repeat;
	int solver, precision; // -1: the scene's
	double accuracy;       // 0: not measured
	bool cut, error, scaling, rest, update, remesh, classroom, json, help;
	int32_t sessions, driven, workers; // of a classroom
	const char *instruction_set;
} bench_options;

// options.c. False after a line on `complaints`.
bool bench_options_read(int argument_count, char **arguments, bench_options *options,
                        FILE *complaints);
void bench_options_help(FILE *out);

typedef struct bench_timing {
	double median_ms, p99_ms, steps_per_s;
	double stage_ms[CAU_STAGE_COUNT]; // medians
} bench_timing;

double bench_now_s(void);
double bench_cpu_s(void); // of all threads
// Median and p99 of `count` values; sorts them.
double bench_quantile(double *values, int32_t count, double quantile);

// Reads the scene by name or path and lays the options over it. NULL and a line on standard error
// if not.
cau_scene_def *bench_scene(const bench_options *options);
// The same with the scene's own accuracy, iterations, solver and precision.
cau_scene_def *bench_scene_as_it_is(const bench_options *options);
cau_session *bench_session(const cau_scene_def *scene, const bench_options *options,
                           int32_t threads);
void bench_submit(cau_session *session, const cau_command *command);
// The next step is computed even where tissue is at rest: gravity is set to what it is.
void bench_keep_awake(cau_session *session);

// steps.c: plain steps with heat and contact on. Returns 0, or 1 after a line on standard error.
typedef struct bench_steps_result {
	bench_timing timing;
	double frame_over_cholmod, cholmod_ms, allocations_per_step, bytes_session;
	int32_t vertices, tetrahedra, triangles, contacts;
	uint64_t hash;
	char instruction_set[16]; // that the session ran on
} bench_steps_result;
int bench_steps(const bench_options *options, bench_steps_result *result);

// cut.c: an energized tool is drawn across the scene.
typedef struct bench_cut_result {
	double plain_median_ms, plain_p99_ms, cut_p99_ms, cut_p99_over_plain, deferred_max_s;
	int32_t elements_removed, cutting_steps, refactorisations;
} bench_cut_result;
int bench_cut(const bench_options *options, bench_cut_result *result);
// cut.c: the errors of its steps, as the session reports them and as they are.
typedef struct bench_along_result {
	int32_t steps, sampled; // sampled: computed again until they converged
	double above;           // share of the steps whose reported error is larger than wanted
	double reported_p50, reported_p95;    // of all steps
	double true_p50, true_p95, true_most; // of sampled steps
	double optimistic; // share of these whose true error is over 3 x the reported
	double iterations_mean, ms_median, ms_p99; // of a step; CPU time of all threads
	int32_t elements_removed;
} bench_along_result;
int bench_along(const bench_options *options, bench_along_result *result);

// error.c: error of K iterations against the converged step, under the scene's pull.
enum { BENCH_CURVE = 9 };
typedef struct bench_error_result {
	double error_at_k, error_max, ms_to_1pct;
	double reference_residual; // worst of the converged steps
	int32_t iterations_to_1pct;
	int32_t curve_iterations[BENCH_CURVE]; // mean error and median time of steps of so many
	double curve_error[BENCH_CURVE], curve_ms[BENCH_CURVE];
} bench_error_result;
int bench_error(const bench_options *options, bench_error_result *result);

// accuracy.c: steps that end at an accuracy against steps of K iterations, by turns.
typedef struct bench_accuracy_result {
	double speedup_over_k;  // time of K iterations over that of the accuracy
	double error_p95;       // of sampled steps, the worst of the whole and of each chunk
	double iterations_mean; // of a step
	double rest_core_share; // of a session that rests, of one core
} bench_accuracy_result;
int bench_accuracy(const bench_options *options, bench_accuracy_result *result);
// Has `to`, a session of the same scene, be in the state of `from`.
void bench_copy_state(cau_session *to, const cau_session *from);
// Its steps iterate until they have converged.
void bench_converge(cau_session *session);

// classroom.c: many sessions at the pace of the clock, some of them driven, by a few workers.
typedef struct bench_classroom_result {
	double realtime_factor_min;   // simulated over wall time, of the session that has least
	double bytes_session_further; // memory that each session after the first adds
	double cores;                 // that were busy with it
	int32_t elements_removed;     // by all tools
} bench_classroom_result;
int bench_classroom(const bench_options *options, bench_classroom_result *result);
// steps.c: the tools of plain steps, one lit above the tissue, one pressed into it.
void bench_place_tools(cau_session *session);

// limit.c: the time that moving its bytes through one core would take a step, if nothing else did.
typedef struct bench_limit_result {
	double bytes_step;    // that the arrays of K iterations hold, counted once a pass
	double bandwidth_b_s; // of reading a block of one iteration's size over and over, one core
	double limit_ms;      // bytes_step / bandwidth_b_s / threads
} bench_limit_result;
int bench_limit(const bench_options *options, bench_limit_result *result);

// scaling.c: step time against size, the slab grown in its plane.
typedef struct bench_scaling_result {
	int32_t count;
	int32_t tetrahedra[4];
	double ms[4];
	double exponent;
} bench_scaling_result;
int bench_scaling(const bench_options *options, bench_scaling_result *result);

// update.c: the matrix kept in step with cuts of so many elements.
enum { BENCH_UPDATES = 5 };
typedef struct bench_update_row {
	int32_t elements;
	double downdate_ms, refactor_ms, anew_ms; // anew: with order and analysis
} bench_update_row;
typedef struct bench_update_result {
	int32_t vertices;
	bench_update_row row[BENCH_UPDATES];
} bench_update_result;
int bench_update(const bench_options *options, bench_update_result *result);

// remesh.c: the scene's cut by a method that changes the topology, and by ours.
typedef struct bench_remesh_result {
	int32_t vertices, elements; // before the cut
	// the other method
	int32_t changes; // ticks in which the mesh changed, and all that rests on it
	int32_t vertices_added, elements_added, ill_shaped;
	int64_t inserts, deletes; // into and from the lists of elements around vertices
	double remesh_s, assemble_s, factor_s;
	double buffer_bytes; // of vertex and index buffers, written anew at each change
	double system_bytes; // of A and its factor, likewise
	// ours
	int32_t our_changes; // ticks in which faces went out of sight, or the factor was changed
	int32_t edges_parted, elements_removed, refactorisations;
	double our_mask_bytes; // of the words of the mask that changed
	double our_s; // of shares, mask, downdates, and of the wait for the factor, in all ticks
} bench_remesh_result;
int bench_remesh(const bench_options *options, bench_remesh_result *result);
// cut.c: our half of it, in a session that nothing has cut.
int bench_cut_ours(cau_session *session, const cau_scene_def *scene, bench_remesh_result *result);

// allocation.c: calls of malloc, calloc, realloc, aligned_alloc by the whole program so far.
uint64_t bench_allocations(void);
