// SPDX-License-Identifier: GPL-3.0-or-later
// Applies A^-1 to a vector, by the packed sweeps or by the diagonal of eq. 7.
#include "cautery/assert.h"
#include "solve/solver.h"

typedef struct sweep_run {
	const cau_step_solver *solver;
	const cau_reals *in; // four reals for each vertex
	cau_reals *out;
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

// Each chunk writes its own rows of the sweep's field only.
static void permute_part(void *context, int32_t chunk)
{
	const sweep_run *run = context;
	const cau_step_solver *solver = run->solver;
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = chunk_end(solver, first);
	CAU_ASSERT(first < last, "chunk %d has rows %d to %d", chunk, first, last);
	solver->kernels->vectors->permute(solver, run->in, run->sign, first, last);
}

static void unpermute_part(void *context, int32_t chunk)
{
	const sweep_run *run = context;
	const cau_step_solver *solver = run->solver;
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = chunk_end(solver, first);
	CAU_ASSERT(first < last, "chunk %d has rows %d to %d", chunk, first, last);
	solver->kernels->vectors->unpermute(solver, run->out, first, last);
}

static void forward_task(void *context, int32_t task)
{
	const cau_step_solver *solver = ((sweep_run *)context)->solver;
	const cau_sweep *sweep = &solver->sweep;
	solver->kernels->vectors->clear_sums(sweep, task);
	for (int32_t s = sweep->task_first[task]; s < sweep->task_last[task]; s++)
		solver->kernels->forward(sweep, s);
}

static void backward_task(void *context, int32_t task)
{
	const cau_step_solver *solver = ((sweep_run *)context)->solver;
	const cau_sweep *sweep = &solver->sweep;
	for (int32_t s = sweep->task_last[task] - 1; s >= sweep->task_first[task]; s--)
		solver->kernels->backward(sweep, s);
}

static void forward_sweep(sweep_run *run)
{
	const cau_step_solver *solver = run->solver;
	const cau_sweep *sweep = &solver->sweep;
	cau_pool_run(solver->pool, sweep->task_count, forward_task, run);
	// in task order, so that the result does not depend on threads
	for (int32_t task = 0; task < sweep->task_count; task++)
		solver->kernels->vectors->add_sums(sweep, task);
	for (int32_t i = 0; i < sweep->top_node_count; i++)
		solver->kernels->forward(sweep, sweep->top_node[i]);
}

static void backward_sweep(sweep_run *run)
{
	const cau_step_solver *solver = run->solver;
	const cau_sweep *sweep = &solver->sweep;
	for (int32_t i = sweep->top_node_count - 1; i >= 0; i--)
		solver->kernels->backward(sweep, sweep->top_node[i]);
	cau_pool_run(solver->pool, sweep->task_count, backward_task, run);
}

void cau_solver_apply_inverse(cau_step_solver *solver, const cau_reals *in, cau_reals *out,
                              double sign)
{
	CAU_ASSERT(sign == 1 || sign == -1, "A^-1 times %g", sign);
	CAU_ASSERT(in != out, "%p is read and written at once", (const void *)in);
	if (solver->settings.diagonal) {
		solver->kernels->vectors->divide(solver, in, out, sign);
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
