// SPDX-License-Identifier: GPL-3.0-or-later
// Operations on vectors of one precision. Compiled twice with these macros: CAU_SINGLE is the
// precision, CAU_VECTORS the name of the table.
#include "solve/vectors.h"

#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "cautery/assert.h"
#include "solve/solver.h"

// ---- any vector
static double at(const cau_reals *array, int64_t index)
{
	return (double)((const real *)array)[index];
}

static void read(const cau_reals *vector, int32_t vertex, double value[3])
{
	CAU_ASSERT(vertex >= 0, "vertex %d", vertex);
	const real *from = (const real *)vector + 4 * (int64_t)vertex;
	for (int c = 0; c < 3; c++)
		value[c] = (double)from[c];
}

static void add(cau_reals *vector, int32_t vertex, const double value[3])
{
	CAU_ASSERT(vertex >= 0, "vertex %d", vertex);
	real *to = (real *)vector + 4 * (int64_t)vertex;
	for (int c = 0; c < 3; c++)
		to[c] = (real)((double)to[c] + value[c]);
}

// Returns the largest value by four maxima in turn, so that no comparison waits for the one before
// it.
static double longest(const cau_reals *vector, int32_t count)
{
	const real *d = (const real *)vector;
	real most[4] = {0};
	CAU_ASSERT(count >= 0, "%d vertices", count);
	for (int32_t v = 0; v < count; v++) {
		const real *at = d + 4 * (int64_t)v;
		real square = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
		most[v & 3] = square > most[v & 3] ? square : most[v & 3];
	}
	real low = most[0] > most[1] ? most[0] : most[1], high = most[2] > most[3] ? most[2] : most[3];
	// the factor makes the result an upper bound in spite of rounding
	return sqrt((double)(low > high ? low : high)) * (1 + 1e-6);
}

static void take_coordinate(cau_reals *column, const cau_reals *vector, int c, int32_t count)
{
	CAU_ASSERT_INDEX(c, 3);
	real *to = (real *)column;
	const real *from = (const real *)vector;
	for (int32_t v = 0; v < count; v++)
		to[v] = from[4 * (int64_t)v + c];
}

// ---- the solver's own vectors
static void displace(const cau_step_solver *solver, int32_t first, int32_t last)
{
	const double *x = solver->position, *rest = solver->tissue->rest;
	real *u = (real *)solver->iterate.displacement;
	for (int32_t v = first; v < last; v++)
		for (int c = 0; c < 3; c++)
			u[4 * v + c] = (real)(x[3 * v + c] - rest[3 * v + c]);
}

static void step(const cau_step_solver *solver, double scale, int32_t first, int32_t last)
{
	double *x = solver->position;
	const double *before = solver->iterate.before;
	const real *d = (const real *)solver->iterate.trial;
	for (int32_t v = first; v < last; v++)
		for (int c = 0; c < 3; c++)
			x[3 * v + c] = before[3 * v + c] + scale * (double)d[4 * v + c];
}

static double add_inertia(const cau_step_solver *solver, int32_t first, int32_t last)
{
	double energy = 0, scale = 1 / (solver->inertia_s * solver->inertia_s);
	const double *x = solver->position, *s = solver->predicted;
	real *gradient = (real *)solver->iterate.gradient;
	for (int32_t v = first; v < last; v++) {
		double m = scale * solver->tissue->mass[v], free = !solver->fixed[v];
		for (int c = 0; c < 3; c++) {
			double away = x[3 * v + c] - s[3 * v + c];
			energy += m * away * away;
			gradient[4 * v + c] = (real)(free * ((double)gradient[4 * v + c] + m * away));
		}
	}
	return energy / 2;
}

static void measure(const cau_step_solver *solver, int32_t first, int32_t last, double sums[4])
{
	const double *x = solver->position, *start = solver->position_start;
	const real *trial = (const real *)solver->iterate.trial;
	const real *increment = (const real *)solver->iterate.increment;
	double mass = 0, trial2 = 0, increment2 = 0, motion2 = 0;
	for (int32_t v = first; v < last; v++) {
		double m = solver->fixed[v] ? 0 : solver->tissue->mass[v];
		mass += m;
		for (int c = 0; c < 3; c++) {
			double s = (double)trial[4 * v + c], d = (double)increment[4 * v + c];
			double way = x[3 * v + c] - start[3 * v + c] + s;
			trial2 += m * s * s;
			increment2 += m * d * d;
			motion2 += m * way * way;
		}
	}
	sums[0] = mass;
	sums[1] = trial2;
	sums[2] = increment2;
	sums[3] = motion2;
}

// ---- A^-1 of a vector
static void divide(const cau_step_solver *solver, const cau_reals *in, cau_reals *out, double sign)
{
	const real *from = (const real *)in;
	real *to = (real *)out;
	for (int32_t v = 0; v < solver->tissue->vertex_count; v++)
		for (int c = 0; c < 3; c++) {
			int64_t i = 4 * (int64_t)v + c;
			double value = (double)from[i];
			to[i] = (real)(solver->fixed[v] ? 0 : sign * value / solver->system.diagonal[v]);
		}
}

static void permute(const cau_step_solver *solver, const cau_reals *in, double sign, int32_t first,
                    int32_t last)
{
	const int32_t *row_at = cau_factor_permutation(solver->factor);
	const int32_t *vertex = solver->system.vertex_of_row;
	vertex_reals *field = (vertex_reals *)solver->sweep.field;
	const vertex_reals *from = (const vertex_reals *)in;
	for (int32_t k = first; k < last; k++)
		field[k] = (real)sign * from[vertex[row_at[k]]];
}

static void unpermute(const cau_step_solver *solver, cau_reals *out, int32_t first, int32_t last)
{
	const int32_t *row_at = cau_factor_permutation(solver->factor);
	const vertex_reals *field = (const vertex_reals *)solver->sweep.field;
	vertex_reals *to = (vertex_reals *)out;
	for (int32_t k = first; k < last; k++) {
		int32_t vertex = solver->system.vertex_of_row[row_at[k]];
		to[vertex] = solver->fixed[vertex] ? (vertex_reals){0} : field[k];
	}
}

static vertex_reals *sums_of(const cau_sweep *sweep, int32_t task)
{
	CAU_ASSERT_INDEX(task, sweep->task_count);
	return (vertex_reals *)sweep->field + cau_sweep_task_place(sweep, task);
}

static void clear_sums(const cau_sweep *sweep, int32_t task)
{
	memset(sums_of(sweep, task), 0, (size_t)sweep->top_count * sizeof(vertex_reals));
}

static void add_sums(const cau_sweep *sweep, int32_t task)
{
	const vertex_reals *sums = sums_of(sweep, task);
	vertex_reals *field = (vertex_reals *)sweep->field;
	for (int32_t i = 0; i < sweep->top_count; i++) {
		CAU_ASSERT_INDEX(sweep->top_column[i], sweep->n);
		field[sweep->top_column[i]] += sums[i];
	}
}

extern const cau_vectors CAU_VECTORS;
const cau_vectors CAU_VECTORS = {
	.real_bytes = sizeof(real),
	// rounding of a sum of thousands of terms, each with an error of about 1e-7 or 1e-16
	.rounding = CAU_SINGLE ? 1e-6 : 1e-13,
	.at = at,
	.read = read,
	.add = add,
	.longest = longest,
	.take_coordinate = take_coordinate,
	.displace = displace,
	.step = step,
	.add_inertia = add_inertia,
	.measure = measure,
	.divide = divide,
	.permute = permute,
	.unpermute = unpermute,
	.clear_sums = clear_sums,
	.add_sums = add_sums,
};
