// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the time of a step if only the transfer of bytes took time. The bytes are those that K
// iterations read and write, with each array once a pass. They are divided by the rate at which one
// core reads a block of the size of one iteration repeatedly. So the block comes from the cache
// that would hold this iteration's arrays.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "session/session_internal.h"

enum { PASSES = 40, RUNS = 5 };

// Numbers of reals and indices that one evaluation of an element of each kind reads and writes
// (constraint/elements.h). Values that a pair of elements shares are read once. Records stay in the
// nearest cache while contributions are added. So a record is counted only when it is written and
// when it is summed.
enum {
	SHEET_REALS = 4 + 6 + 1 + 3 + 2 * 6,
	FAT_REALS = 9 + 1,
	FAT_LIMIT_REALS = 2 * 4,
	FAT_TARGET_REALS = 6,
	FAT_SHRUNK_REALS = 1, // the weight of the limit of fat that has no limit except by shrinkage
	FAT_PLASTIC_REALS = 6,
	LINK_REALS = 3 + 1 + 1,
	HINGE_REALS = 4 + 3 + 1 + 1,
	RECORD_REALS = 2 * 4,
	SHEET_INDICES = 4 / 2,
	LINK_INDICES = 2,
	HINGE_INDICES = 4,
};
static const double FAT_INDICES = 5 / 2.0;

static double bytes_of_elements(const cau_elements *e)
{
	double real_bytes = (double)cau_real_bytes(e->single), fat_reals = 0;
	for (int32_t g = 0; g < e->fat.group_count; ++g) {
		const cau_fat_group *group = &e->fat.group[g];
		int32_t first = group->first_slot / CAU_BATCH;
		for (int32_t b = first; b < first + group->slot_count / CAU_BATCH; ++b) {
			int limited = e->fat.limited[b];
			fat_reals += CAU_BATCH * (FAT_REALS + limited * FAT_LIMIT_REALS +
			                          limited * e->fat.targeted[b] * FAT_TARGET_REALS +
			                          limited * !group->limit * FAT_SHRUNK_REALS +
			                          e->fat.flowed[b] * FAT_PLASTIC_REALS);
		}
	}
	double reals = (double)e->sheet.slot_count * SHEET_REALS + fat_reals +
	               (double)e->link.slot_count * LINK_REALS +
	               (double)e->hinge.slot_count * HINGE_REALS +
	               (double)e->record_count * RECORD_REALS;
	double places =
		(double)e->sheet.slot_count * SHEET_INDICES + (double)e->fat.slot_count * FAT_INDICES +
		(double)e->link.slot_count * LINK_INDICES + (double)e->hinge.slot_count * HINGE_INDICES;
	// Two indices are read for each record: the index of its vertex, to fetch the displacement, and
	// the index of the record, to sum the forces of the vertex.
	double names = 2.0 * e->record_count;
	return reals * real_bytes + places * sizeof(uint16_t) + names * sizeof(int32_t);
}

// Returns the bytes of a solve. Each sweep reads the panels once, except the zeros above diagonal
// blocks. Right-hand sides and permutations are small in comparison.
static double bytes_of_solve(const cau_step_solver *solver)
{
	return solver->settings.diagonal ? 0
	                                 : 2.0 * (double)solver->sweep.panel_entries *
	                                       (double)cau_sweep_entry_bytes(&solver->sweep);
}

// Returns the bytes of the vertices. Position, its start, prediction and step are double.
// Displacement, gradient, increments and the window of the acceleration (a column each of df and h)
// are real.
static double bytes_of_vertices(const cau_step_solver *solver)
{
	double doubles = 5 * 3, reals = 4 * (6 + 3 * CAU_ANDERSON_WINDOW);
	return solver->tissue->vertex_count *
	       (doubles * sizeof(double) + reals * (double)cau_real_bytes(solver->elements.single));
}

// Returns the bytes per second that one core reads, the best of a few runs.
static double bandwidth(const cau_step_solver *solver, double bytes)
{
	size_t half = (size_t)bytes / 2 / 64 * 64;
	int64_t n = (int64_t)(half / cau_real_bytes(solver->elements.single));
	char *block = aligned_alloc(64, 2 * half);
	double best = 0;
	if (!block)
		return 0;
	memset(block, 0, 2 * half);
	const cau_reals *a = (const cau_reals *)block, *b = (const cau_reals *)(block + half);
	for (int run = 0; run < RUNS; ++run) {
		double start = bench_now_s();
		for (int pass = 0; pass < PASSES; ++pass)
			solver->kernels->dot(a, b, 0, n);
		best = fmax(best, PASSES * 2.0 * (double)half / (bench_now_s() - start));
	}
	free(block);
	return best;
}

int bench_limit(const bench_options *options, bench_limit_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	if (!scene)
		return 1;
	cau_session *session = bench_session(scene, options, 1);
	free(scene);
	if (!session)
		return 1;
	const cau_step_solver *solver = &session->solver;
	double bytes =
		bytes_of_elements(&solver->elements) + bytes_of_solve(solver) + bytes_of_vertices(solver);
	result->bytes_step = bytes * options->iterations;
	result->bandwidth_b_s = bandwidth(solver, bytes);
	result->limit_ms = 1e3 * result->bytes_step / result->bandwidth_b_s / options->threads;
	cau_session_destroy(session);
	return 0;
}
