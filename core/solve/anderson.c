// SPDX-License-Identifier: GPL-3.0-or-later
// Anderson acceleration of the iteration x <- x + f(x), f = -A^-1 grad E [Walker and Ni 2011], with
// least squares in the norm of A. Since A f = -grad E, inner products in this norm are dot products
// of increments and gradients. The weights of past iterates sum to one. So the accelerated
// iteration keeps the momentum as the plain iteration does.
#include <string.h>

#include "cautery/assert.h"
#include "solve/solver.h"

// The state of one mix of the history. With contact, A f = -grad E + reactions. The solver's
// gradient vector then has the negative of that sum.
typedef struct mix {
	cau_step_solver *solver;
	double weight[CAU_ANDERSON_WINDOW];
} mix;

static int64_t chunk_reals(const cau_step_solver *solver, int32_t chunk, int64_t *first)
{
	int32_t vertex, last = cau_solver_chunk_end(solver, chunk, &vertex);
	*first = 4 * (int64_t)vertex;
	return 4 * (int64_t)(last - vertex);
}

void cau_anderson_start(cau_step_solver *solver)
{
	solver->anderson.history.count = 0;
	solver->anderson.history.newest = -1;
}

static void column_part(void *context, int32_t chunk)
{
	const mix *work = context;
	const cau_step_solver *solver = work->solver;
	int64_t first, n = chunk_reals(solver, chunk, &first);
	solver->kernels->add_column(&solver->anderson.history, first, n,
	                            solver->chunks.dot + (size_t)chunk * (2 * CAU_ANDERSON_WINDOW));
}

static void combine_part(void *context, int32_t chunk)
{
	const mix *work = context;
	const cau_step_solver *solver = work->solver;
	int64_t first, n = chunk_reals(solver, chunk, &first);
	solver->kernels->combine(&solver->anderson.history, first, n, work->weight);
}

// Solves the small symmetric system by Gaussian elimination with diagonal pivots. Its entries are
// products. If a pivot is 1e-8 of its column's own size, only a ten-thousandth of the column's
// length has a new direction. A smaller pivot is noise in single precision, and its column gets the
// weight 0.
static void least_squares(double a[CAU_ANDERSON_WINDOW][CAU_ANDERSON_WINDOW],
                          double b[CAU_ANDERSON_WINDOW], int32_t count, double *x)
{
	CAU_ASSERT(count >= 1 && count <= CAU_ANDERSON_WINDOW, "%d columns", count);
	double size[CAU_ANDERSON_WINDOW];
	int used[CAU_ANDERSON_WINDOW];
	for (int32_t i = 0; i < count; i++)
		size[i] = a[i][i];
	for (int32_t p = 0; p < count; p++) {
		used[p] = a[p][p] > 1e-8 * size[p] && size[p] > 0;
		for (int32_t i = p + 1; i < count && used[p]; i++) {
			double ratio = a[i][p] / a[p][p];
			for (int32_t j = p; j < count; j++)
				a[i][j] -= ratio * a[p][j];
			b[i] -= ratio * b[p];
		}
	}
	for (int32_t p = count - 1; p >= 0; p--) {
		x[p] = 0;
		if (!used[p])
			continue;
		double sum = b[p];
		for (int32_t j = p + 1; j < count; j++)
			sum -= a[p][j] * x[j];
		x[p] = sum / a[p][p];
	}
}

// Adds the newest column and its products with all columns, summed in chunk order. Then finds the
// weights of the columns.
static void weigh(mix *work)
{
	cau_step_solver *solver = work->solver;
	cau_history *history = &solver->anderson.history;
	history->newest = (history->newest + 1) % CAU_ANDERSON_WINDOW;
	CAU_ASSERT_INDEX(history->newest, CAU_ANDERSON_WINDOW);
	if (history->count < CAU_ANDERSON_WINDOW)
		history->count++;
	cau_pool_run(solver->pool, solver->chunks.count, column_part, work);
	double b[CAU_ANDERSON_WINDOW] = {0}, a[CAU_ANDERSON_WINDOW][CAU_ANDERSON_WINDOW];
	for (int32_t j = 0; j < history->count; j++) {
		double product = 0;
		for (int32_t c = 0; c < solver->chunks.count; c++) {
			const double *dot = solver->chunks.dot + (size_t)c * (2 * CAU_ANDERSON_WINDOW);
			product += dot[j];
			b[j] += dot[CAU_ANDERSON_WINDOW + j];
		}
		solver->anderson.product[history->newest][j] = product;
		solver->anderson.product[j][history->newest] = product;
	}
	memcpy(a, solver->anderson.product, sizeof a);
	least_squares(a, b, history->count, work->weight);
}

bool cau_anderson_mix(cau_step_solver *solver, int32_t iteration)
{
	CAU_ASSERT(iteration >= 0, "iteration %d", iteration);
	CAU_ASSERT(iteration > 0 || !solver->anderson.history.count,
	           "the first iteration has %d columns", solver->anderson.history.count);
	mix work = {.solver = solver};
	solver->anderson.history.increment = solver->iterate.increment;
	solver->anderson.history.gradient = solver->iterate.gradient;
	if (iteration > 0)
		weigh(&work);
	cau_pool_run(solver->pool, solver->chunks.count, combine_part, &work);
	return solver->anderson.history.count > 0;
}

static void swap(cau_reals **a, cau_reals **b)
{
	cau_reals *kept = *a;
	*a = *b;
	*b = kept;
}

void cau_anderson_keep(cau_step_solver *solver)
{
	CAU_ASSERT(solver->anderson.history.increment == solver->iterate.increment,
	           "what is kept was not mixed, with %d columns", solver->anderson.history.count);
	swap(&solver->iterate.increment, &solver->anderson.history.last_increment);
	swap(&solver->iterate.gradient, &solver->anderson.history.last_gradient);
}
