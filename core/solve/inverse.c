// SPDX-License-Identifier: GPL-3.0-or-later
// A^-1 of a vector: by the packed sweeps, or by the diagonal of eq. 7.
#include <string.h>

#include "cautery/assert.h"
#include "solve/solver.h"

typedef float vertex_single __attribute__((vector_size(16), may_alias));
typedef double vertex_double __attribute__((vector_size(32), may_alias));

typedef struct sweep_run {
	const cau_step_solver *solver;
	const void *in; // real by vertex
	void *out;
	double sign;
} sweep_run;

static int32_t row_chunks(const cau_step_solver *solver)
{
	return (solver->system.row_count + CAU_VERTEX_CHUNK - 1) / CAU_VERTEX_CHUNK;
}

static int32_t chunk_end(const cau_step_solver *solver, int32_t first)
{
	int32_t last = first + CAU_VERTEX_CHUNK;
	return last < solver->system.row_count ? last : solver->system.row_count;
}

// field[place] = sign * in[vertex]: by place, so that a chunk writes what no other does.
static void permute_part(void *context, int32_t chunk)
{
	const sweep_run *run = context;
	const cau_step_solver *solver = run->solver;
	const int32_t *row_at = cau_factor_permutation(solver->factor);
	const int32_t *vertex = solver->system.vertex_of_row;
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = chunk_end(solver, first);
	CAU_ASSERT(first < last, "chunk %d has rows %d to %d", chunk, first, last);
	if (solver->elements.single) {
		vertex_single *field = solver->sweep.field;
		const vertex_single *in = run->in;
		float sign = (float)run->sign;
		for (int32_t k = first; k < last; ++k)
			field[k] = sign * in[vertex[row_at[k]]];
	} else {
		vertex_double *field = solver->sweep.field;
		const vertex_double *in = run->in;
		for (int32_t k = first; k < last; ++k)
			field[k] = run->sign * in[vertex[row_at[k]]];
	}
}

static void unpermute_part(void *context, int32_t chunk)
{
	const sweep_run *run = context;
	const cau_step_solver *solver = run->solver;
	const int32_t *row_at = cau_factor_permutation(solver->factor);
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = chunk_end(solver, first);
	CAU_ASSERT(first < last, "chunk %d has rows %d to %d", chunk, first, last);
	for (int32_t k = first; k < last; ++k) {
		int32_t vertex = solver->system.vertex_of_row[row_at[k]];
		if (solver->elements.single)
			((vertex_single *)run->out)[vertex] = solver->fixed[vertex]
			                                          ? (vertex_single){0}
			                                          : ((vertex_single *)solver->sweep.field)[k];
		else
			((vertex_double *)run->out)[vertex] = solver->fixed[vertex]
			                                          ? (vertex_double){0}
			                                          : ((vertex_double *)solver->sweep.field)[k];
	}
}

static void *task_sums(const cau_step_solver *solver, int32_t task)
{
	CAU_ASSERT_INDEX(task, solver->sweep.task_count);
	size_t reals = 4 * (size_t)cau_sweep_task_place(&solver->sweep, task);
	return (char *)solver->sweep.field + reals * cau_real_bytes(solver->elements.single);
}

static void forward_task(void *context, int32_t task)
{
	const cau_step_solver *solver = ((sweep_run *)context)->solver;
	const cau_sweep *sweep = &solver->sweep;
	memset(task_sums(solver, task), 0,
	       4 * (size_t)sweep->top_count * cau_real_bytes(solver->elements.single));
	for (int32_t s = sweep->task_first[task]; s < sweep->task_last[task]; ++s)
		solver->kernels->forward(sweep, s);
}

static void backward_task(void *context, int32_t task)
{
	const cau_step_solver *solver = ((sweep_run *)context)->solver;
	const cau_sweep *sweep = &solver->sweep;
	for (int32_t s = sweep->task_last[task] - 1; s >= sweep->task_first[task]; --s)
		solver->kernels->backward(sweep, s);
}

// Adds the tasks' sums for the rows above them, in task order.
static void add_task_sums(const cau_step_solver *solver)
{
	const cau_sweep *sweep = &solver->sweep;
	for (int32_t task = 0; task < sweep->task_count; ++task) {
		const void *sums = task_sums(solver, task);
		for (int32_t i = 0; i < sweep->top_count; ++i) {
			int32_t place = sweep->top_column[i];
			CAU_ASSERT_INDEX(place, sweep->n);
			if (solver->elements.single)
				((vertex_single *)sweep->field)[place] += ((const vertex_single *)sums)[i];
			else
				((vertex_double *)sweep->field)[place] += ((const vertex_double *)sums)[i];
		}
	}
}

static void forward_sweep(sweep_run *run)
{
	const cau_step_solver *solver = run->solver;
	const cau_sweep *sweep = &solver->sweep;
	cau_pool_run(solver->pool, sweep->task_count, forward_task, run);
	add_task_sums(solver);
	for (int32_t i = 0; i < sweep->top_node_count; ++i)
		solver->kernels->forward(sweep, sweep->top_node[i]);
}

static void backward_sweep(sweep_run *run)
{
	const cau_step_solver *solver = run->solver;
	const cau_sweep *sweep = &solver->sweep;
	for (int32_t i = sweep->top_node_count - 1; i >= 0; --i)
		solver->kernels->backward(sweep, sweep->top_node[i]);
	cau_pool_run(solver->pool, sweep->task_count, backward_task, run);
}

void cau_solver_apply_inverse(cau_step_solver *solver, const void *in, void *out, double sign)
{
	CAU_ASSERT(sign == 1 || sign == -1, "A^-1 times %g", sign);
	CAU_ASSERT(in != out, "%p is read and written at once", in);
	if (solver->diagonal) {
		for (int32_t v = 0; v < solver->tissue->vertex_count; ++v)
			for (int c = 0; c < 3; ++c) {
				int64_t i = 4 * (int64_t)v + c;
				double value = cau_real_get(in, solver->elements.single, i);
				cau_real_set(out, solver->elements.single, i,
				             solver->fixed[v] ? 0 : sign * value / solver->system.diagonal[v]);
			}
		return;
	}
	CAU_ASSERT(solver->sweep.n == solver->system.row_count,
	           "a factor of %d rows for a system of %d", solver->sweep.n, solver->system.row_count);
	sweep_run run = {.solver = solver, .in = in, .out = out, .sign = sign};
	cau_pool_run(solver->pool, row_chunks(solver), permute_part, &run);
	forward_sweep(&run);
	backward_sweep(&run);
	cau_pool_run(solver->pool, row_chunks(solver), unpermute_part, &run);
}
