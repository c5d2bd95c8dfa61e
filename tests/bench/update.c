// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the cost of updating the matrix after a cut (section 7.2), over the number of removed
// elements. There are three ways. Exact downdates of the factor are for cuts of a few elements. A
// numeric factorisation with the present pattern is for cuts of many elements. A method whose cuts
// change the topology, and so the pattern, must order, analyse and factorise again. Each time
// includes all work before the next solve (packing), and excludes the steps between cuts.
//
// A cut removes the elements nearest to the scene's line of cut.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "session/session_internal.h"

enum { ROUNDS = 5 }; // number of rounds; each result is the smallest time of these rounds

typedef struct ranked {
	double distance_m;
	int32_t element;
} ranked;

static double segment_distance(const double at[3], const double from[3], const double to[3])
{
	double along = 0, length2 = 0, square = 0;
	for (int c = 0; c < 3; c++) {
		along += (at[c] - from[c]) * (to[c] - from[c]);
		length2 += (to[c] - from[c]) * (to[c] - from[c]);
	}
	double t = length2 > 0 ? fmin(1, fmax(0, along / length2)) : 0;
	for (int c = 0; c < 3; c++) {
		double off = at[c] - from[c] - t * (to[c] - from[c]);
		square += off * off;
	}
	return sqrt(square);
}

static int by_distance(const void *a, const void *b)
{
	const ranked *first = a, *second = b;
	if (first->distance_m != second->distance_m)
		return first->distance_m < second->distance_m ? -1 : 1;
	return (first->element > second->element) - (first->element < second->element);
}

// Returns the `count` elements nearest to the line, or NULL if memory ran out.
static cau_waiting *nearest_elements(const cau_session *session, int kind, int32_t of,
                                     const cau_scene_def *scene, int32_t count)
{
	const cau_tissue *tissue = &session->tissue;
	ranked *all = calloc((size_t)of, sizeof *all);
	cau_waiting *list = calloc((size_t)count, sizeof *list);
	if (!all || !list) {
		free(all);
		free(list);
		return NULL;
	}
	for (int32_t e = 0; e < of; e++) {
		cau_element_map map;
		double centre[3] = {0, 0, 0};
		cau_tissue_element_map(tissue, kind, e, &map);
		for (int k = 0; k < map.vertex_count; k++)
			for (int c = 0; c < 3; c++)
				centre[c] += tissue->rest[3 * (size_t)map.vertex[k] + (size_t)c] / map.vertex_count;
		all[e] = (ranked){segment_distance(centre, scene->cut.from_m, scene->cut.to_m), e};
	}
	qsort(all, (size_t)of, sizeof *all, by_distance);
	for (int32_t k = 0; k < count; k++)
		list[k] = (cau_waiting){.kind = kind, .element = all[k].element};
	free(all);
	return list;
}

static int take_out(cau_matrix_update *update, const cau_waiting *list, int32_t count)
{
	for (int32_t done = 0, taken = 0; done < count; done += taken)
		if (cau_matrix_update_downdate(update, list + done, count - done, &taken, NULL))
			return 1;
	cau_matrix_update_pack(update);
	return 0;
}

static int factor_anew(const cau_session *session, const cau_alive *alive)
{
	const cau_step_solver *solver = &session->solver;
	cau_factor *factor = NULL;
	cau_system_assemble(&solver->system, solver->tissue, alive, solver->step_s,
	                    solver->system.matrix.value);
	cau_status status = cau_factor_create(&factor, &solver->system.matrix, NULL, NULL);
	cau_factor_destroy(factor);
	return status != CAU_OK;
}

static void keep_least(double *least_ms, double start_s)
{
	double ms = 1e3 * (bench_now_s() - start_s);
	if (*least_ms == 0 || ms < *least_ms)
		*least_ms = ms;
}

// Measures one cut in each of the three ways. The factor is complete again afterwards.
static int measure(cau_session *session, const cau_waiting *list, bench_update_row *row)
{
	cau_matrix_update *update = &session->update;
	const cau_alive *alive = &session->dissection.alive;
	double start = bench_now_s();
	if (take_out(update, list, row->elements))
		return 1;
	keep_least(&row->downdate_ms, start);
	for (int32_t k = 0; k < row->elements; k++)
		alive->element[list[k].kind][list[k].element] = 0;
	start = bench_now_s();
	int failed = cau_matrix_update_refactor(update, alive, NULL) != CAU_OK;
	keep_least(&row->refactor_ms, start);
	start = bench_now_s();
	failed = failed || factor_anew(session, alive);
	keep_least(&row->anew_ms, start);
	for (int32_t k = 0; k < row->elements; k++)
		alive->element[list[k].kind][list[k].element] = 1;
	return failed || cau_matrix_update_refactor(update, alive, NULL);
}

static int measure_all(cau_session *session, const cau_scene_def *scene,
                       bench_update_result *result)
{
	static const int32_t counts[BENCH_UPDATES] = {1, 4, 16, 64, 256};
	cau_session_info info;
	cau_session_describe(session, &info);
	bool solid = info.tetrahedron_count > 0;
	int32_t of = solid ? info.tetrahedron_count : info.triangle_count;
	int kind = solid ? CAU_ELEMENT_TETRAHEDRON : CAU_ELEMENT_TRIANGLE;
	int failed = of < counts[BENCH_UPDATES - 1];
	cau_waiting *list =
		failed ? NULL : nearest_elements(session, kind, of, scene, counts[BENCH_UPDATES - 1]);
	result->vertices = info.vertex_count;
	for (int i = 0; i < BENCH_UPDATES; i++)
		result->row[i].elements = counts[i];
	for (int round = 0; round < ROUNDS && list && !failed; round++)
		for (int i = 0; i < BENCH_UPDATES && !failed; i++)
			failed = measure(session, list, &result->row[i]);
	failed = failed || !list;
	free(list);
	return failed;
}

int bench_update(const bench_options *options, bench_update_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	cau_session *session = scene ? bench_session(scene, options, 1) : NULL;
	int failed =
		!session || session->solver.settings.diagonal || measure_all(session, scene, result);
	if (session && failed)
		fprintf(stderr, "cautery-bench: the cut of %s could not be measured\n", options->scene);
	cau_session_destroy(session);
	free(scene);
	return failed;
}
