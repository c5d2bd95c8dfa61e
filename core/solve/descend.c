// SPDX-License-Identifier: GPL-3.0-or-later
// The iteration of one step (section 4, figure 3): local and global by turns, accelerated,
// safeguarded.
#include <math.h>
#include <string.h>

#include "constraint/contact.h"
#include "solve/solver.h"

// What rounding can do to the objective, relative to its terms.
static double objective_noise(const cau_step_solver *solver)
{
	return (solver->elements.single ? 1e-6 : 1e-13) * fabs(cau_solver_elastic_energy(solver));
}

typedef struct move {
	cau_step_solver *solver;
	double scale;
	int leave; // the present position becomes position_before
} move;

// position = position_before + scale * trial_increment, and the displacement of that
static void move_part(void *context, int32_t chunk)
{
	const move *work = context;
	cau_step_solver *solver = work->solver;
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK;
	if (last > solver->tissue->vertex_count)
		last = solver->tissue->vertex_count;
	double *before = solver->position_before, *x = solver->position;
	if (work->leave)
		memcpy(before + 3 * first, x + 3 * first, 3 * (size_t)(last - first) * sizeof *x);
	if (solver->elements.single) {
		const float *d = solver->trial_increment;
		for (int32_t v = first; v < last; ++v)
			for (int c = 0; c < 3; ++c)
				x[3 * v + c] = before[3 * v + c] + work->scale * (double)d[4 * v + c];
	} else {
		const double *d = solver->trial_increment;
		for (int32_t v = first; v < last; ++v)
			for (int c = 0; c < 3; ++c)
				x[3 * v + c] = before[3 * v + c] + work->scale * d[4 * v + c];
	}
	cau_solver_displace_chunk(solver, chunk);
}

static void leave(cau_step_solver *solver)
{
	cau_pool_run(solver->pool, solver->chunk_count, move_part, &(move){solver, 1, 1});
}

static void move_to(cau_step_solver *solver, double scale)
{
	cau_pool_run(solver->pool, solver->chunk_count, move_part, &(move){solver, scale, 0});
}

static void scale_trial(cau_step_solver *solver, double scale)
{
	solver->kernels->add_scaled(solver->trial_increment, scale - 1, solver->trial_increment,
	                            4 * (int64_t)solver->tissue->vertex_count);
}

static void use_plain_step(cau_step_solver *solver)
{
	memcpy(solver->trial_increment, solver->history.last_increment,
	       4 * (size_t)solver->tissue->vertex_count * cau_real_bytes(solver->elements.single));
}

// Where the parabola through the objective before the step, its slope there and its value after a
// part `scale` of the step has its bottom: at most half of the part, at least a hundredth of it.
// Tissue drawn far beyond its rest is thousands of times stiffer than A, and halving alone would
// not come down to it.
static double shorter(double scale, double before, double after, double slope)
{
	double rise = after - before - slope * scale;
	double bottom = isfinite(after) && rise > 0 ? -slope * scale / (2 * rise) : 0;
	return scale * fmin(fmax(bottom, 0.01), 0.5);
}

// Takes the trial step if it lowers the objective; else the plain step, whose slope is `slope`;
// else shortens it. Laws without an energy take the first finite step. Returns 0 when nothing
// helps: the position is as before.
static int take_step(cau_step_solver *solver, int accelerated, double slope, double *objective)
{
	double bound = *objective + objective_noise(solver);
	if (solver->contact)
		bound += cau_contact_work(solver->contact, solver);
	double scale = 1;
	leave(solver);
	for (int tries = 0; tries <= CAU_MAX_BACKTRACKS; ++tries) {
		double value = cau_solver_evaluate_displaced(solver);
		if (isfinite(value) && (!solver->conservative || value <= bound)) {
			*objective = value;
			if (scale != 1)
				scale_trial(solver, scale);
			return 1;
		}
		solver->backtracks++;
		if (accelerated) {
			use_plain_step(solver);
			accelerated = 0;
		} else {
			scale = shorter(scale, *objective, value, slope);
		}
		move_to(solver, tries < CAU_MAX_BACKTRACKS ? scale : 0);
	}
	*objective = cau_solver_evaluate_displaced(solver);
	return 0;
}

// When the first step had to be shortened, the guess x + dt v may be far up a slope that a few
// short steps do not come down: then the start of the tick is the better guess. From there, or from
// a guess that is lower still, eq. 4 only falls, so that a tick never ends with more energy than it
// began with. Returns whether it went back.
static int go_back(cau_step_solver *solver, double *objective)
{
	size_t count = (size_t)solver->tissue->vertex_count;
	if (!solver->position_start || !solver->conservative)
		return 0;
	memcpy(solver->position_before, solver->position, 3 * count * sizeof(double));
	for (size_t v = 0; v < count; ++v)
		if (!solver->fixed[v])
			memcpy(solver->position + 3 * v, solver->position_start + 3 * v, 3 * sizeof(double));
	double value = cau_solver_evaluate(solver);
	if (value < *objective) {
		cau_anderson_start(solver);
		*objective = value;
		return 1;
	}
	memcpy(solver->position, solver->position_before, 3 * count * sizeof(double));
	*objective = cau_solver_evaluate(solver);
	return 0;
}

static void norm_part(void *context, int32_t chunk)
{
	const cau_step_solver *solver = context;
	size_t real = cau_real_bytes(solver->elements.single);
	int64_t first = 4 * (int64_t)chunk * CAU_VERTEX_CHUNK, n = 4 * (int64_t)CAU_VERTEX_CHUNK;
	if (first + n > 4 * (int64_t)solver->tissue->vertex_count)
		n = 4 * (int64_t)solver->tissue->vertex_count - first;
	solver->chunk_dot[chunk] =
		solver->kernels->dot((const char *)solver->increment + (size_t)first * real,
	                         (const char *)solver->gradient + (size_t)first * real, n);
}

static double step_norm(cau_step_solver *solver)
{
	double product = 0;
	cau_pool_run(solver->pool, solver->chunk_count, norm_part, solver);
	for (int32_t chunk = 0; chunk < solver->chunk_count; ++chunk)
		product += solver->chunk_dot[chunk];
	return sqrt(fmax(-product, 0));
}

static void nothing(void *context)
{
	(void)context;
}

void cau_solver_begin(cau_step_solver *solver, void (*meanwhile)(void *context), void *context)
{
	solver->iterations_done = solver->backtracks = 0;
	solver->local_s = solver->contact_s = 0;
	solver->residual = 0;
	solver->objective = cau_solver_evaluate_beside(solver, meanwhile, context);
}

cau_status cau_solver_run(cau_step_solver *solver, cau_error *error)
{
	cau_solver_begin(solver, nothing, NULL);
	return cau_solver_descend(solver, error);
}

cau_status cau_solver_descend(cau_step_solver *solver, cau_error *error)
{
	double objective = solver->objective, first = 0, last = 0;
	int32_t steps = 0; // since the guess
	cau_anderson_start(solver);
	for (int32_t k = 0; k < solver->iterations; ++k) {
		cau_solver_global(solver);
		double norm = step_norm(solver);
		if (!isfinite(norm) || !isfinite(objective))
			return cau_fail(error, CAU_NUMERICAL, NULL,
			                "the state is not finite after %d iterations", k);
		if (!k)
			first = norm;
		solver->residual = first > 0 ? norm / first : 0;
		solver->iterations_done = k + 1;
		if (norm == 0 || (k && solver->residual <= solver->tolerance))
			break;
		if (!solver->conservative && k && norm > 2 * last)
			cau_anderson_start(solver); // the history misleads: forget it
		last = norm;
		int accelerated = cau_anderson_mix(solver, steps++);
		if (!solver->conservative && k + 1 == solver->iterations) { // nothing to compare with
			leave(solver);
			break;
		}
		cau_anderson_keep(solver);
		int taken = take_step(solver, accelerated, -norm * norm, &objective);
		int back = !k && solver->backtracks && go_back(solver, &objective);
		if (!taken && !back)
			break;
		if (back)
			steps = 0;
	}
	cau_solver_displace(solver);
	return CAU_OK;
}
