// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/newton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "solve/solver.h"

// SETTLED: R is settled once a step of Newton's method moves none of R's vertices by more than this
// share of the error that the session's step may have. SETTLED_M: least value of this limit, m. The
// allowed error is `accuracy` times the motion of the tick, and at least half a micrometre
// (accuracy.c).
static const double SETTLED = 0.1, SETTLED_M = 5e-8;
// SETTLED_M for a step without a wanted accuracy; this is rounding
static const double SETTLED_EXACTLY_M = 1e-12;
// Least motion of R, m, by which a length is divided to get a relative error. So with little
// motion, an error of half a micrometre is 1 %.
static const double NOTHING_M = 5e-5;
// Bounds, m, for the way that a vertex of R may move while R settles once, with tissue contact.
// Between the bounds, the way is the longest motion of a vertex of R in the tick. All pairs within
// the way must be known.
static const double LEAST_WAY_M = 1e-4, MOST_WAY_M = 1e-3;
// MOST_STEPS: most steps of Newton's method for R in one iteration. MOST_PART_STEPS: after each of
// these steps, most steps for the part of R that still moves. A tab that comes free and buckles
// takes up to 25 steps.
enum { MOST_STEPS = 4, MOST_PART_STEPS = 12 };
// Least decrease of E in a step, as a share of the decrease that the slope predicts [Armijo 1966].
static const double ARMIJO = 1e-4;
// Share of the decrease that the slope predicts. A step that lowers the energy by more than this
// share was too short. (On a quadratic, a full step lowers the energy by half of the amount that
// the slope predicts.) The next step then replaces negative eigenvalues by 0.
static const double TOO_SHORT = 0.8;

// ---- vectors by row

static void clear_rows(const cau_newton *newton, const cau_step_solver *solver, cau_reals *of)
{
	for (int32_t i = 0; i < newton->n; i++) {
		double is[3];
		solver->kernels->vectors->read(of, newton->vertex[i], is);
		for (int c = 0; c < 3; c++)
			is[c] = -is[c];
		solver->kernels->vectors->add(of, newton->vertex[i], is);
	}
}

static void add_rows(const cau_newton *newton, const cau_step_solver *solver, cau_reals *to,
                     const double *of)
{
	for (int32_t i = 0; i < newton->n; i++)
		solver->kernels->vectors->add(to, newton->vertex[i], of + 4 * (int64_t)i);
}

// field = -H_RR^-1 (gradient + H_RN d_N), where `increment` has d_N; NULL: d_N = 0.
static void solve(cau_newton *newton, const cau_step_solver *solver, const cau_reals *increment)
{
	for (int64_t i = 0; i < 4 * (int64_t)newton->n; i++)
		newton->field[i] = -newton->gradient[i];
	for (int32_t k = 0; increment && k < newton->coupling_count; k++) {
		const cau_newton_coupling *by = &newton->coupling[k];
		double d[3], *to = newton->field + 4 * (int64_t)by->row;
		solver->kernels->vectors->read(increment, by->vertex, d);
		for (int r = 0; r < 3; r++)
			to[r] -=
				by->block[3 * r] * d[0] + by->block[3 * r + 1] * d[1] + by->block[3 * r + 2] * d[2];
	}
	solver->kernels->newton_solve(newton);
}

// gradient_N += scale H_NR `of`
static void spread(const cau_newton *newton, cau_step_solver *solver, double scale,
                   const double *of)
{
	for (int32_t k = 0; k < newton->coupling_count; k++) {
		const cau_newton_coupling *by = &newton->coupling[k];
		const double *d = of + 4 * (int64_t)by->row;
		double load[3];
		for (int c = 0; c < 3; c++)
			load[c] =
				scale * (by->block[c] * d[0] + by->block[3 + c] * d[1] + by->block[6 + c] * d[2]);
		solver->kernels->vectors->add(solver->iterate.gradient, by->vertex, load);
	}
}

static double length2(const double *of)
{
	return of[0] * of[0] + of[1] * of[1] + of[2] * of[2];
}

// ---- settle

static void move_rows(const cau_newton *newton, cau_step_solver *solver, double scale)
{
	for (int32_t i = 0; i < newton->n; i++)
		for (int c = 0; c < 3; c++)
			solver->position[3 * newton->vertex[i] + c] =
				newton->from[4 * i + c] + scale * newton->field[4 * i + c];
}

static void keep_rows(const cau_newton *newton, const cau_step_solver *solver)
{
	for (int32_t i = 0; i < newton->n; i++)
		memcpy(newton->from + 4 * (int64_t)i, solver->position + 3 * (int64_t)newton->vertex[i],
		       3 * sizeof(double));
}

// Returns the part of the step to try next: the minimum of E + slope t + c t^4, with the part t. A
// sheet that turns along a straight step is stretched by the square of the part, so E rises by the
// part's fourth power.
static double shorter(double scale, double rise, double slope)
{
	double least = rise > 0 && isfinite(rise) ? cbrt(-slope * scale / (4 * rise)) : 0;
	return scale * fmin(fmax(least, 0.05), 0.5);
}

// Takes the step in `field`, or a shorter part of the step, so that the energy falls. Returns false
// if no part of the step lowers the energy.
static bool take_step(cau_newton *newton, cau_step_solver *solver)
{
	double energy = newton->energy, slope = 0, scale = 1;
	double noise = 1e-13 * fabs(energy); // rounding of the sum
	for (int64_t i = 0; i < 4 * (int64_t)newton->n; i++)
		slope += newton->field[i] * newton->gradient[i];
	keep_rows(newton, solver);
	for (int tries = 0; tries <= CAU_MAX_BACKTRACKS; tries++) {
		move_rows(newton, solver, scale);
		cau_newton_measure(newton, solver);
		double fall = newton->energy - energy;
		if (fall <= ARMIJO * scale * slope + noise) {
			newton->negative = tries || fall > TOO_SHORT * slope;
			return true;
		}
		scale = shorter(scale, newton->energy - energy - slope * scale, slope);
	}
	move_rows(newton, solver, 0);
	return false;
}

// Limits a vertex's step to `most`, m. With tissue contact, also limits its distance from the start
// of the settling to way_m.
static void keep_within(const cau_step_solver *solver, double *way, int32_t vertex, double most)
{
	double length = sqrt(length2(way)), whole[3];
	for (int c = 0; c < 3 && length > most; c++)
		way[c] *= most / length;
	if (!solver->collide)
		return;
	const double *x = solver->position + 3 * (int64_t)vertex;
	const double *from = solver->iterate.before + 3 * (int64_t)vertex;
	for (int c = 0; c < 3; c++)
		whole[c] = x[c] + way[c] - from[c];
	double share = solver->loose.way_m / sqrt(length2(whole));
	for (int c = 0; c < 3 && share < 1; c++)
		way[c] = from[c] + share * whole[c] - x[c];
}

typedef enum outcome { STILL, MOVED, STUCK, NO_MEMORY } outcome;

// One step of Newton's method. Returns STILL if the step would move no vertex: H is then factored
// at R's present position.
static outcome step(cau_newton *newton, cau_step_solver *solver)
{
	double most2 = 0, still = solver->loose.still_m;
	solver->loose.work += newton->element_count;
	if (!cau_newton_assemble(newton, solver))
		return NO_MEMORY;
	if (!solver->kernels->newton_factor(newton))
		return STUCK; // the state is not finite
	solve(newton, solver, NULL);
	for (int32_t i = 0; i < newton->n; i++)
		most2 = fmax(most2, length2(newton->field + 4 * (int64_t)i));
	if (most2 <= still * still)
		return STILL;
	for (int32_t i = 0; i < newton->n; i++)
		keep_within(solver, newton->field + 4 * (int64_t)i, newton->vertex[i], newton->room[i]);
	return take_step(newton, solver) ? MOVED : STUCK;
}

// True if this step of the session has used up its limit of work for Newton's method.
static bool is_spent(const cau_step_solver *solver)
{
	return !solver->settings.newton_chosen && solver->loose.work >= CAU_NEWTON_WORK;
}

// Chooses the vertices that the last step of Newton's method moved.
static void choose_part(cau_loose *loose)
{
	const cau_newton *region = &loose->region;
	double still2 = loose->still_m * loose->still_m;
	for (int32_t i = 0; i < region->n; i++)
		loose->part.chosen[region->vertex[i]] = length2(region->field + 4 * (int64_t)i) > still2;
}

// Steps of Newton's method for the part of R that still moves, while the rest of R is held. Most of
// R settles soon.
static outcome settle_part(cau_step_solver *solver)
{
	cau_loose *loose = &solver->loose;
	outcome last = MOVED;
	choose_part(loose);
	if (!cau_newton_create(&loose->part, solver, &loose->region) ||
	    !cau_newton_find_touching(&loose->part, solver, &loose->region))
		return NO_MEMORY;
	for (int k = 0; k < MOST_PART_STEPS && last == MOVED && loose->part.n && !is_spent(solver); k++)
		last = step(&loose->part, solver);
	return last;
}

// Returns R's motion since the tick began, m, root mean square.
static double motion_of(const cau_step_solver *solver)
{
	const cau_newton *region = &solver->loose.region;
	double motion = 0;
	for (int32_t i = 0; i < region->n && solver->position_start; i++)
		for (size_t at = 3 * (size_t)region->vertex[i], c = at; c < at + 3; c++) {
			double way = solver->position[c] - solver->position_start[c];
			motion += way * way;
		}
	return sqrt(motion / region->n);
}

// Returns the length of R's last step, relative to R's motion in the tick.
static double left_to_do(const cau_step_solver *solver)
{
	const cau_newton *region = &solver->loose.region;
	double last = 0;
	for (int32_t i = 0; i < region->n; i++)
		last += length2(region->field + 4 * (int64_t)i);
	return sqrt(last / region->n) / fmax(motion_of(solver), NOTHING_M);
}

// Returns the longest motion of a vertex of R since the tick began, m.
static double longest_motion(const cau_step_solver *solver)
{
	const cau_newton *region = &solver->loose.region;
	double most2 = 0;
	for (int32_t i = 0; i < region->n && solver->position_start; i++) {
		size_t at = 3 * (size_t)region->vertex[i];
		cau_vec3 from = cau_vec3_of(solver->position_start + at);
		cau_vec3 way = cau_sub(cau_vec3_of(solver->position + at), from);
		most2 = fmax(most2, cau_dot(way, way));
	}
	return sqrt(most2);
}

// Finds all pairs of tissue contact within the distance that R may move. Returns false if there are
// more than the capacity.
static bool surround(cau_step_solver *solver)
{
	const cau_newton *region = &solver->loose.region;
	if (!solver->collide)
		return true;
	solver->loose.way_m = fmin(fmax(longest_motion(solver), LEAST_WAY_M), MOST_WAY_M);
	return cau_collide_surround(solver->collide, solver->pool, solver->position, region->vertex,
	                            region->n, solver->loose.way_m);
}

static outcome settle(cau_step_solver *solver)
{
	cau_loose *loose = &solver->loose;
	outcome last = MOVED;
	loose->left = 0;
	loose->region.negative = loose->part.negative = 1;
	if (!surround(solver))
		return STUCK;
	if (!cau_newton_find_touching(&loose->region, solver, NULL))
		return NO_MEMORY;
	loose->still_m = solver->accuracy.wanted > 0
	                     ? fmax(SETTLED_M, SETTLED * solver->accuracy.wanted * motion_of(solver))
	                     : SETTLED_EXACTLY_M;
	for (int k = 0; k < MOST_STEPS && last == MOVED && !is_spent(solver); k++) {
		last = step(&loose->region, solver);
		loose->left = last == STILL ? 0 : left_to_do(solver);
		if (last == MOVED && k + 1 < MOST_STEPS && settle_part(solver) == NO_MEMORY)
			return NO_MEMORY;
	}
	loose->settled = last == STILL;
	return last;
}

// Restores all positions. R is left to A for the rest of the step.
static void give_up(cau_step_solver *solver, double *objective)
{
	memcpy(solver->position, solver->iterate.before,
	       3 * (size_t)solver->tissue->vertex_count * sizeof(double));
	solver->loose.given_up = true;
	*objective = cau_solver_evaluate(solver);
}

static bool has_moved(const cau_step_solver *solver)
{
	const cau_newton *region = &solver->loose.region;
	for (int32_t i = 0; i < region->n; i++)
		for (size_t at = 3 * (size_t)region->vertex[i], c = at; c < at + 3; c++)
			if (solver->position[c] != solver->iterate.before[c])
				return true;
	return false;
}

// Limits R's motion from iterate.before so that it crosses no other tissue. Keeps iterate.trial.
// Returns true if the motion was shortened.
static bool keep_apart(cau_step_solver *solver)
{
	const cau_newton *region = &solver->loose.region;
	const cau_vectors *vectors = solver->kernels->vectors;
	cau_reals *way = solver->iterate.trial;
	solver->iterate.trial = solver->yield.residual;
	solver->yield.residual = way;
	size_t n = (size_t)solver->tissue->vertex_count;
	memset(solver->iterate.trial, 0, 4 * n * vectors->real_bytes);
	for (int32_t i = 0; i < region->n; i++) {
		double of[3];
		for (size_t c = 0; c < 3; c++) {
			size_t at = 3 * (size_t)region->vertex[i] + c;
			of[c] = solver->position[at] - solver->iterate.before[at];
		}
		vectors->add(solver->iterate.trial, region->vertex[i], of);
	}
	bool held_back = solver->collide->filter.held_back;
	cau_collide_stand(solver->collide, solver->iterate.before);
	bool stopped = cau_solver_keep_apart(solver, solver->iterate.before);
	solver->collide->filter.held_back = held_back;
	for (size_t v = 0; v < n && stopped; v++) {
		double of[3];
		vectors->read(solver->iterate.trial, (int32_t)v, of);
		for (size_t c = 0; c < 3; c++)
			solver->position[3 * v + c] = solver->iterate.before[3 * v + c] + of[c];
	}
	way = solver->iterate.trial;
	solver->iterate.trial = solver->yield.residual;
	solver->yield.residual = way;
	return stopped;
}

cau_status cau_loose_settle(cau_step_solver *solver, double *objective, cau_error *error)
{
	cau_loose *loose = &solver->loose;
	double before = *objective;
	CAU_ASSERT(loose->region.n > 0, "%d rows to settle", loose->region.n);
	memcpy(solver->iterate.before, solver->position,
	       3 * (size_t)solver->tissue->vertex_count * sizeof(double));
	outcome last = settle(solver);
	if (last == NO_MEMORY)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for Newton's steps");
	loose->moved = has_moved(solver);
	loose->fresh = last == STILL;
	if (loose->moved && solver->collide && keep_apart(solver))
		loose->settled = loose->fresh = false;
	if (loose->moved)
		*objective = cau_solver_evaluate(solver);
	if (!(*objective <= before + cau_solver_noise(solver, 0)))
		give_up(solver, objective);
	loose->given_up |= is_spent(solver);
	return CAU_OK;
}

// ---- increment

// Shifts the increment so that the mean position becomes the mean of s. This is for a body that
// nothing holds: M does not keep the body's momentum, as A does. Forces between the body's parts do
// not move its mean position.
static void keep_momentum(cau_step_solver *solver)
{
	const cau_tissue *tissue = solver->tissue;
	double mass = 0, sum[3] = {0}, d[3];
	if (solver->system.row_count < tissue->vertex_count || solver->forces.drag_count ||
	    solver->contact)
		return; // something holds the tissue
	for (int32_t v = 0; v < tissue->vertex_count; v++) {
		double m = solver->fixed[v] ? 0 : tissue->mass[v];
		solver->kernels->vectors->read(solver->iterate.increment, v, d);
		mass += m;
		for (int c = 0; c < 3; c++)
			sum[c] += m * (solver->position[3 * v + c] + d[c] - solver->predicted[3 * v + c]);
	}
	for (int c = 0; c < 3; c++)
		sum[c] /= -mass;
	for (int32_t v = 0; v < tissue->vertex_count; v++)
		if (!solver->fixed[v])
			solver->kernels->vectors->add(solver->iterate.increment, v, sum);
}

void cau_loose_increment(cau_step_solver *solver)
{
	cau_newton *region = &solver->loose.region;
	bool ready = solver->loose.fresh ||
	             (cau_newton_assemble(region, solver) && solver->kernels->newton_factor(region));
	if (!ready) {
		solver->loose.given_up = true;
		cau_solver_global(solver);
		return;
	}
	solver->loose.work += solver->loose.fresh ? 0 : region->element_count;
	solve(region, solver, NULL);
	double *e = region->from;
	memcpy(e, region->field, 4 * (size_t)region->n * sizeof *e);
	clear_rows(region, solver, solver->iterate.gradient);
	spread(region, solver, 1, e);
	cau_solver_global(solver);
	spread(region, solver, -1, e);
	add_rows(region, solver, solver->iterate.gradient, region->gradient);
	solve(region, solver, solver->iterate.increment);
	clear_rows(region, solver, solver->iterate.increment);
	add_rows(region, solver, solver->iterate.increment, region->field);
	keep_momentum(solver);
}
