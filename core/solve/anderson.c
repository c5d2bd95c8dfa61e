// SPDX-License-Identifier: GPL-3.0-or-later
// Anderson acceleration of the iteration x <- x + f(x), f = -A^-1 grad E [Walker and Ni 2011],
// least squares in the norm of A: since A f = -grad E, every inner product is one of increments
// with gradients. The weights of past iterates sum to one, so momentum is kept as by the plain
// iteration.
#include <string.h>

#include "solve/solver.h"

// With contact A f = -grad E + reactions; the solver's gradient vector then holds that sum's
// negative.
typedef struct mix {
	cau_step_solver *solver;
	int32_t count, newest;
	double weight[CAU_ANDERSON_WINDOW];
} mix;

static size_t chunk_reals(const cau_step_solver *solver, int32_t chunk, size_t *first)
{
	size_t total = 4 * (size_t)solver->tissue->vertex_count;
	*first = 4 * (size_t)chunk * CAU_VERTEX_CHUNK;
	size_t count = 4 * CAU_VERTEX_CHUNK;
	return *first + count > total ? total - *first : count;
}

static void *at(const cau_step_solver *solver, void *array, size_t real_index)
{
	return (char *)array + real_index * cau_real_bytes(solver->elements.single);
}

void cau_anderson_start(cau_step_solver *solver)
{
	solver->anderson_count = 0;
	solver->anderson_next = 0;
}

// df = f - f_last, dg = g - g_last, h = step + df, and the products df_j . dg of all columns.
static void difference_part(void *context, int32_t chunk)
{
	mix *work = context;
	cau_step_solver *solver = work->solver;
	const cau_kernels *k = solver->kernels;
	size_t first, n = chunk_reals(solver, chunk, &first);
	size_t bytes = n * cau_real_bytes(solver->elements.single);
	void *df = at(solver, solver->anderson_df[work->newest], first);
	void *h = at(solver, solver->anderson_h[work->newest], first);
	void *dg = at(solver, solver->difference, first);
	memcpy(df, at(solver, solver->increment, first), bytes);
	k->add_scaled(df, -1, at(solver, solver->last_increment, first), (int64_t)n);
	memcpy(h, at(solver, solver->trial_increment, first), bytes);
	k->add_scaled(h, 1, df, (int64_t)n);
	memcpy(dg, at(solver, solver->gradient, first), bytes);
	k->add_scaled(dg, -1, at(solver, solver->last_gradient, first), (int64_t)n);
	double *dot = solver->chunk_dot + (size_t)chunk * (2 * CAU_ANDERSON_WINDOW);
	for (int32_t j = 0; j < work->count; ++j) {
		const void *column = at(solver, solver->anderson_df[j], first);
		dot[j] = -k->dot(column, dg, (int64_t)n);
		dot[CAU_ANDERSON_WINDOW + j] =
			-k->dot(column, at(solver, solver->gradient, first), (int64_t)n);
	}
}

// trial = f - sum of weight_j h_j
static void combine_part(void *context, int32_t chunk)
{
	mix *work = context;
	cau_step_solver *solver = work->solver;
	size_t first, n = chunk_reals(solver, chunk, &first);
	void *trial = at(solver, solver->trial_increment, first);
	memcpy(trial, at(solver, solver->increment, first),
	       n * cau_real_bytes(solver->elements.single));
	for (int32_t j = 0; j < work->count; ++j)
		solver->kernels->add_scaled(trial, -work->weight[j],
		                            at(solver, solver->anderson_h[j], first), (int64_t)n);
}

// Solves the small symmetric system by Gaussian elimination with diagonal pivots; columns that add
// nothing new (pivot below 1e-8 of their own size) get no weight.
static void least_squares(double a[CAU_ANDERSON_WINDOW][CAU_ANDERSON_WINDOW],
                          double b[CAU_ANDERSON_WINDOW], int32_t count, double *x)
{
	double size[CAU_ANDERSON_WINDOW];
	int used[CAU_ANDERSON_WINDOW];
	for (int32_t i = 0; i < count; ++i)
		size[i] = a[i][i];
	for (int32_t p = 0; p < count; ++p) {
		used[p] = a[p][p] > 1e-8 * size[p] && size[p] > 0;
		for (int32_t i = p + 1; i < count && used[p]; ++i) {
			double ratio = a[i][p] / a[p][p];
			for (int32_t j = p; j < count; ++j)
				a[i][j] -= ratio * a[p][j];
			b[i] -= ratio * b[p];
		}
	}
	for (int32_t p = count - 1; p >= 0; --p) {
		x[p] = 0;
		if (!used[p])
			continue;
		double sum = b[p];
		for (int32_t j = p + 1; j < count; ++j)
			sum -= a[p][j] * x[j];
		x[p] = sum / a[p][p];
	}
}

int cau_anderson_mix(cau_step_solver *solver, int32_t iteration)
{
	mix work = {.solver = solver};
	if (iteration > 0) {
		work.newest = solver->anderson_next;
		solver->anderson_next = (solver->anderson_next + 1) % CAU_ANDERSON_WINDOW;
		if (solver->anderson_count < CAU_ANDERSON_WINDOW)
			solver->anderson_count++;
		work.count = solver->anderson_count;
		cau_pool_run(solver->pool, solver->chunk_count, difference_part, &work);
		double b[CAU_ANDERSON_WINDOW] = {0}, a[CAU_ANDERSON_WINDOW][CAU_ANDERSON_WINDOW];
		for (int32_t j = 0; j < work.count; ++j) {
			double product = 0;
			for (int32_t c = 0; c < solver->chunk_count; ++c) {
				const double *dot = solver->chunk_dot + (size_t)c * (2 * CAU_ANDERSON_WINDOW);
				product += dot[j];
				b[j] += dot[CAU_ANDERSON_WINDOW + j];
			}
			solver->anderson_product[work.newest][j] = product;
			solver->anderson_product[j][work.newest] = product;
		}
		memcpy(a, solver->anderson_product, sizeof a);
		least_squares(a, b, work.count, work.weight);
	}
	cau_pool_run(solver->pool, solver->chunk_count, combine_part, &work);
	return work.count > 0;
}

void cau_anderson_accept(cau_step_solver *solver)
{
	size_t bytes =
		4 * (size_t)solver->tissue->vertex_count * cau_real_bytes(solver->elements.single);
	memcpy(solver->last_increment, solver->increment, bytes);
	memcpy(solver->last_gradient, solver->gradient, bytes);
}
