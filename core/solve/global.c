// SPDX-License-Identifier: GPL-3.0-or-later
// The global step: increment = -A^-1 gradient by the packed sweeps, or by the diagonal of eq. 7.
#include <string.h>

#include "constraint/contact.h"
#include "solve/solver.h"

typedef struct sweep_run {
	cau_step_solver *solver;
	void *rhs[3];
	const void *in; // real by vertex
	void *out;
	double sign;
} sweep_run;

static void *offset(void *array, int single, int64_t reals)
{
	return (char *)array + (size_t)reals * cau_real_bytes(single);
}

static int32_t row_chunks(const cau_step_solver *solver)
{
	return (solver->system.row_count + CAU_VERTEX_CHUNK - 1) / CAU_VERTEX_CHUNK;
}

// rhs[place] = sign * in[vertex]: by place, so that a chunk writes what no other does.
static void permute_part(void *context, int32_t chunk)
{
	sweep_run *run = context;
	const cau_step_solver *solver = run->solver;
	const int32_t *row_at = cau_factor_permutation(solver->factor);
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK;
	if (last > solver->system.row_count)
		last = solver->system.row_count;
	if (solver->elements.single) {
		float sign = (float)run->sign;
		const float *in = run->in;
		for (int32_t k = first; k < last; ++k) {
			const float *at = in + 4 * (int64_t)solver->system.vertex_of_row[row_at[k]];
			for (int c = 0; c < 3; ++c)
				((float *)run->rhs[c])[k] = sign * at[c];
		}
	} else {
		const double *in = run->in;
		for (int32_t k = first; k < last; ++k) {
			const double *at = in + 4 * (int64_t)solver->system.vertex_of_row[row_at[k]];
			for (int c = 0; c < 3; ++c)
				((double *)run->rhs[c])[k] = run->sign * at[c];
		}
	}
}

static void unpermute_part(void *context, int32_t chunk)
{
	sweep_run *run = context;
	const cau_step_solver *solver = run->solver;
	const int32_t *row_at = cau_factor_permutation(solver->factor);
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK;
	if (last > solver->system.row_count)
		last = solver->system.row_count;
	for (int32_t k = first; k < last; ++k) {
		int32_t vertex = solver->system.vertex_of_row[row_at[k]];
		for (int c = 0; c < 3; ++c) {
			if (solver->elements.single)
				((float *)run->out)[4 * (int64_t)vertex + c] =
					solver->fixed[vertex] ? 0 : ((float *)run->rhs[c])[k];
			else
				((double *)run->out)[4 * (int64_t)vertex + c] =
					solver->fixed[vertex] ? 0 : ((double *)run->rhs[c])[k];
		}
	}
}

static void above_of(const cau_step_solver *solver, int32_t task, void *above[3])
{
	for (int c = 0; c < 3; ++c)
		above[c] = offset(solver->sweep.above, solver->elements.single,
		                  (int64_t)(3 * task + c) * solver->sweep.padded_top);
}

static void forward_task(void *context, int32_t task)
{
	sweep_run *run = context;
	cau_step_solver *solver = run->solver;
	void *above[3];
	above_of(solver, task, above);
	for (int c = 0; c < 3; ++c)
		memset(above[c], 0,
		       (size_t)solver->sweep.top_count * cau_real_bytes(solver->elements.single));
	for (int32_t s = solver->sweep.task_first[task]; s < solver->sweep.task_last[task]; ++s)
		solver->kernels->forward(&solver->sweep, s, run->rhs, above, solver->sweep_work[task]);
}

static void backward_task(void *context, int32_t task)
{
	sweep_run *run = context;
	cau_step_solver *solver = run->solver;
	for (int32_t s = solver->sweep.task_last[task] - 1; s >= solver->sweep.task_first[task]; --s)
		solver->kernels->backward(&solver->sweep, s, run->rhs, solver->sweep_work[task]);
}

// Takes the tasks' sums for the rows above them off the right-hand side, in task order.
static void gather_above(sweep_run *run)
{
	const cau_step_solver *solver = run->solver;
	const cau_sweep *sweep = &solver->sweep;
	for (int32_t task = 0; task < sweep->task_count; ++task) {
		void *above[3];
		above_of(solver, task, above);
		for (int c = 0; c < 3; ++c) {
			if (solver->elements.single)
				for (int32_t i = 0; i < sweep->top_count; ++i)
					((float *)run->rhs[c])[sweep->top_column[i]] -= ((float *)above[c])[i];
			else
				for (int32_t i = 0; i < sweep->top_count; ++i)
					((double *)run->rhs[c])[sweep->top_column[i]] -= ((double *)above[c])[i];
		}
	}
}

static void forward_sweep(sweep_run *run)
{
	cau_step_solver *solver = run->solver;
	void *none[3] = {NULL, NULL, NULL};
	cau_pool_run(solver->pool, solver->sweep.task_count, forward_task, run);
	gather_above(run);
	for (int32_t i = 0; i < solver->sweep.top_node_count; ++i)
		solver->kernels->forward(&solver->sweep, solver->sweep.top_node[i], run->rhs, none,
		                         solver->sweep_work[CAU_SWEEP_TASKS]);
}

static void backward_sweep(sweep_run *run)
{
	cau_step_solver *solver = run->solver;
	for (int32_t i = solver->sweep.top_node_count - 1; i >= 0; --i)
		solver->kernels->backward(&solver->sweep, solver->sweep.top_node[i], run->rhs,
		                          solver->sweep_work[CAU_SWEEP_TASKS]);
	cau_pool_run(solver->pool, solver->sweep.task_count, backward_task, run);
}

void cau_solver_apply_inverse(cau_step_solver *solver, const void *in, void *out, double sign)
{
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
	sweep_run run = {.solver = solver, .in = in, .out = out, .sign = sign};
	for (int c = 0; c < 3; ++c)
		run.rhs[c] =
			offset(solver->sweep.rhs, solver->elements.single, (int64_t)c * solver->sweep.padded_n);
	cau_pool_run(solver->pool, row_chunks(solver), permute_part, &run);
	forward_sweep(&run);
	backward_sweep(&run);
	cau_pool_run(solver->pool, row_chunks(solver), unpermute_part, &run);
}

void cau_solver_global(cau_step_solver *solver)
{
	if (solver->contact)
		cau_contact_load(solver->contact, solver);
	cau_solver_apply_inverse(solver, solver->gradient, solver->increment, -1);
	double start = solver->now_s ? solver->now_s() : 0;
	if (solver->contact)
		cau_contact_correct(solver->contact, solver);
	if (solver->now_s)
		solver->contact_s += solver->now_s() - start;
}
