// SPDX-License-Identifier: GPL-3.0-or-later
// The iteration of one step (section 4, figure 3): local and global steps alternate, with
// acceleration and a safeguard.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"
#include "solve/solver.h"

static double rounding(const cau_step_solver *solver)
{
	return solver->kernels->vectors->rounding;
}

// ---- products of vectors by vertex
typedef struct product {
	cau_step_solver *solver;
	const cau_reals *a, *b;
} product;

static void product_part(void *context, int32_t chunk)
{
	const product *work = context;
	const cau_step_solver *solver = work->solver;
	int32_t first, last = cau_solver_chunk_end(solver, chunk, &first);
	solver->chunks.dot[chunk] =
		solver->kernels->dot(work->a, work->b, 4 * (int64_t)first, 4 * (int64_t)(last - first));
}

static double dot(cau_step_solver *solver, const cau_reals *a, const cau_reals *b)
{
	double sum = 0;
	cau_pool_run(solver->pool, solver->chunks.count, product_part, &(product){solver, a, b});
	for (int32_t chunk = 0; chunk < solver->chunks.count; chunk++)
		sum += solver->chunks.dot[chunk];
	return sum;
}

// ---- steps
typedef struct move {
	cau_step_solver *solver;
	double scale;
	bool leave; // copy position to iterate.before first
} move;

// position = iterate.before + scale * iterate.trial; updates the displacement
static void move_part(void *context, int32_t chunk)
{
	const move *work = context;
	cau_step_solver *solver = work->solver;
	int32_t first, last = cau_solver_chunk_end(solver, chunk, &first);
	if (work->leave)
		memcpy(solver->iterate.before + 3 * first, solver->position + 3 * first,
		       3 * (size_t)(last - first) * sizeof *solver->position);
	solver->kernels->vectors->step(solver, work->scale, first, last);
	solver->kernels->vectors->displace(solver, first, last);
}

static void leave(cau_step_solver *solver)
{
	cau_pool_run(solver->pool, solver->chunks.count, move_part, &(move){solver, 1, 1});
}

static void move_to(cau_step_solver *solver, double scale)
{
	cau_pool_run(solver->pool, solver->chunks.count, move_part, &(move){solver, scale, 0});
}

static void scale_trial(cau_step_solver *solver, double scale)
{
	solver->kernels->add_scaled(solver->iterate.trial, scale - 1, solver->iterate.trial,
	                            4 * (int64_t)solver->tissue->vertex_count);
}

static void use_plain_step(cau_step_solver *solver)
{
	memcpy(solver->iterate.trial, solver->anderson.history.last_increment,
	       4 * (size_t)solver->tissue->vertex_count * solver->kernels->vectors->real_bytes);
}

// Moves by a part `scale` of the plain step, filtered so that tissue does not cross tissue. A short
// enough step is not filtered and lowers the objective.
static void move_apart(cau_step_solver *solver, double scale)
{
	use_plain_step(solver);
	scale_trial(solver, scale);
	cau_collide_stand(solver->collide, solver->iterate.before);
	cau_solver_keep_apart(solver, solver->iterate.before);
	move_to(solver, 1);
}

// Returns a shorter part of the step: the minimum of a parabola through the objective before the
// step, the slope there, and the objective after a part `scale` of the step. Tissue that is
// stretched far beyond its rest shape is thousands of times stiffer than A. If the part were only
// halved, the number of tries would not be enough. But a parabola describes such tissue poorly. So
// the result is at most half of `scale`, to make progress. It is at least a hundredth of `scale`,
// so that the step is not abandoned.
static double shorter(double scale, double before, double after, double slope)
{
	CAU_ASSERT(scale > 0 && scale <= 1, "a part of %g of the step", scale);
	CAU_ASSERT(!(slope > 0), "a slope of %g J", slope);
	double rise = after - before - slope * scale;
	double bottom = isfinite(after) && rise > 0 ? -slope * scale / (2 * rise) : 0;
	return scale * fmin(fmax(bottom, 0.01), 0.5);
}

// True if the trial step, of which a part `scale` was taken, is accepted. The condition is that eq.
// 4 with every element's energy does not rise. A law without an energy contributes w/2 |R|^2. Near
// the fixed point of such a law, its forces can lead to a higher value. In that case the condition
// is that the work against all forces along the step is negative, by the trapezoidal rule between
// the step's ends. This work is negative for every step that is short enough. So laws with an
// energy keep their safeguard.
static bool may_stand(cau_step_solver *solver, double scale, double value, double objective,
                      double noise)
{
	if (value <= objective + noise)
		return true;
	if (solver->settings.conservative || !isfinite(value))
		return false;
	double start = dot(solver, solver->anderson.history.last_gradient, solver->iterate.trial);
	double end = dot(solver, solver->iterate.gradient, solver->iterate.trial);
	return 0.5 * scale * (start + end) <= noise + rounding(solver) * fabs(start);
}

// Takes the trial step if it is accepted. Otherwise tries the plain step, whose slope is `slope`,
// and then shorter steps. Returns false if no step is accepted: the position is then unchanged.
static bool take_step(cau_step_solver *solver, bool accelerated, double slope, double *objective)
{
	CAU_ASSERT(!(slope > 0), "a step that leads up: %g J", slope);
	double noise = cau_solver_noise(solver, -slope);
	if (solver->contact)
		noise += cau_contact_work(solver->contact, solver);
	double scale = 1;
	if (solver->collide)
		cau_solver_keep_apart(solver, solver->position);
	leave(solver);
	for (int tries = 0; tries <= CAU_MAX_BACKTRACKS; tries++) {
		double value = cau_solver_evaluate_displaced(solver);
		if (may_stand(solver, solver->collide ? 1 : scale, value, *objective, noise)) {
			*objective = value;
			if (scale != 1 && !solver->collide)
				scale_trial(solver, scale);
			return true;
		}
		solver->result.backtracks++;
		if (accelerated) {
			use_plain_step(solver);
			accelerated = false;
		} else {
			scale = shorter(scale, *objective, value, slope);
		}
		if (tries == CAU_MAX_BACKTRACKS)
			move_to(solver, 0);
		else if (solver->collide)
			move_apart(solver, scale);
		else
			move_to(solver, scale);
	}
	*objective = cau_solver_evaluate_displaced(solver);
	return false;
}

// Restarts the iteration at the start of the tick if the objective is lower there. Called when the
// first step had to be shortened: the objective at the guess x + dt v may be so high that a few
// short steps cannot lower it enough. After a restart eq. 4 only falls, so that a tick never ends
// with more energy than it began with. Returns true if the iteration restarted.
static bool go_back(cau_step_solver *solver, double *objective)
{
	size_t count = (size_t)solver->tissue->vertex_count;
	if (!solver->position_start)
		return false;
	memcpy(solver->iterate.before, solver->position, 3 * count * sizeof(double));
	for (size_t v = 0; v < count; v++)
		if (!solver->fixed[v])
			memcpy(solver->position + 3 * v, solver->position_start + 3 * v, 3 * sizeof(double));
	double value = cau_solver_evaluate(solver);
	if (value < *objective) {
		cau_anderson_start(solver);
		*objective = value;
		return true;
	}
	memcpy(solver->position, solver->iterate.before, 3 * count * sizeof(double));
	*objective = cau_solver_evaluate(solver);
	return false;
}

static double step_norm(cau_step_solver *solver)
{
	return sqrt(fmax(-dot(solver, solver->iterate.increment, solver->iterate.gradient), 0));
}

// True if the last step can be taken without an evaluation. That requires that no step of this tick
// was taken back, and that the square of the step's length is less than the rounding of E's change.
// (The square of the length is the expected decrease of E.) If a law has no energy, a bad step
// would not show in E. Then a hundredth of E is the limit: even if the step added as much, the tick
// would not show it.
static bool is_harmless(const cau_step_solver *solver, double norm, double objective)
{
	CAU_ASSERT(!(norm < 0), "a step of length %g", norm);
	const double far_below = 0.01;
	double most = solver->settings.conservative ? cau_solver_noise(solver, norm * norm)
	                                            : far_below * objective;
	bool touches = solver->collide && solver->collide->result.touching_count;
	return !solver->result.backtracks && !solver->forces.drag_count && !touches &&
	       norm * norm <= most;
}

// True if the step was shortened so that tissue does not cross tissue. The length of such a step
// says nothing about the remaining error.
static bool is_held_back(const cau_step_solver *solver)
{
	return solver->collide && solver->collide->filter.held_back;
}

// True if the active constraints of tools changed in this increment. The contraction of the
// increments is then meaningless.
static bool meets_others(const cau_step_solver *solver)
{
	return solver->contact && solver->contact->others;
}

// True if the active constraints changed, or if their points moved on their faces.
static bool touches_elsewhere(const cau_step_solver *solver)
{
	return meets_others(solver) || (solver->contact && solver->contact->elsewhere);
}

// Updates the hash of the pairs of tissue that touch. Returns whether the pairs have changed:
// earlier steps then predict nothing.
static bool forget_touching(const cau_step_solver *solver, uint64_t *touching)
{
	bool changed = solver->collide->result.touching_hash != *touching;
	*touching = solver->collide->result.touching_hash;
	return changed;
}

static void nothing(void *context)
{
	(void)context;
}

void cau_solver_begin(cau_step_solver *solver, void (*meanwhile)(void *context), void *context)
{
	CAU_ASSERT(meanwhile != NULL, "nothing to do beside the local step of %p", context);
	solver->result.iterations = solver->result.backtracks = 0;
	solver->result.local_s = solver->result.contact_s = 0;
	solver->result.residual = 0;
	solver->result.objective = cau_solver_evaluate_beside(solver, meanwhile, context);
}

cau_status cau_solver_run(cau_step_solver *solver, cau_error *error)
{
	cau_solver_begin(solver, nothing, NULL);
	return cau_solver_descend(solver, error);
}

// Computes the increment by A, or by Newton's method if tissue is loose.
static void find_increment(cau_step_solver *solver)
{
	if (solver->loose.region.n && !solver->loose.given_up)
		cau_loose_increment(solver);
	else
		cau_solver_global(solver);
}

// Finds the first increment by A alone, without Newton's method: A moves a free piece exactly, as
// in free fall. Vertices that the increment would move farther than contact can follow are excluded
// from tissue contact. Then the increment is computed again.
static void find_first_increment(cau_step_solver *solver, double *objective)
{
	cau_solver_global(solver);
	if (!solver->collide || !cau_solver_let_go(solver))
		return;
	*objective = cau_solver_evaluate(solver);
	cau_solver_global(solver);
}

static void forget_increments(cau_step_solver *solver)
{
	if (solver->contact)
		cau_contact_begin(solver->contact);
	cau_anderson_start(solver);
	cau_accuracy_begin(&solver->accuracy);
}

// The state between the iterations of a round.
typedef struct descent {
	double objective, first, last; // J; norm of the first increment; norm of the last increment
	int32_t steps;                 // increments since the history was discarded
	int32_t backtracks_before;     // backtracks of earlier rounds in this tick
	uint64_t touching;
	bool near; // the last increment was within the accuracy
} descent;

static void forget_history(cau_step_solver *solver, descent *d)
{
	cau_anderson_start(solver);
	d->steps = 0;
}

// Mixes the increment into the history. Returns whether the step is accelerated.
static bool mix(cau_step_solver *solver, descent *d, int32_t k, double norm)
{
	if (k == 1 && solver->loose.region.n) // from here on, increments are computed with M
		forget_history(solver, d);
	// Steps of a converging iteration get shorter. If a law has no energy, a bad mix would not show
	// in the energy. So a step of double length is taken as a sign of a misleading history. The
	// history is then discarded.
	if (!solver->settings.conservative && k && norm > 2 * d->last)
		cau_anderson_start(solver);
	d->last = norm;
	return cau_anderson_mix(solver, d->steps++);
}

// Takes the last step of a round without an evaluation if is_harmless allows it. Returns whether it
// took the step.
static bool spare(cau_step_solver *solver, descent *d, double norm)
{
	if (!is_harmless(solver, norm, d->objective) ||
	    (solver->collide && cau_solver_keep_apart(solver, solver->position)))
		return false;
	leave(solver);
	solver->result.spared = true;
	d->objective -= norm * norm / 2;
	return true;
}

// Takes the mixed step, then settles the loose region. Returns true if the round ends.
static bool advance(cau_step_solver *solver, descent *d, int32_t k, bool accelerated, double norm,
                    cau_status *status, cau_error *error)
{
	cau_loose *loose = &solver->loose;
	int32_t backtracks = solver->result.backtracks;
	cau_anderson_keep(solver);
	bool taken = take_step(solver, accelerated, -norm * norm, &d->objective);
	bool back =
		!k && solver->result.backtracks > d->backtracks_before && go_back(solver, &d->objective);
	if (back) {
		d->steps = 0;
		cau_accuracy_begin(&solver->accuracy);
	}
	bool straight = taken && solver->result.backtracks == backtracks && !is_held_back(solver);
	if (d->near && straight && loose->settled)
		return true;
	if (loose->region.n && !loose->given_up)
		*status = cau_loose_settle(solver, &d->objective, error);
	if (*status || (!taken && !back && !loose->moved))
		return true;
	if (d->near && straight && loose->settled && !loose->moved)
		return true;
	if (solver->collide && forget_touching(solver, &d->touching))
		forget_history(solver, d);
	return false;
}

static int32_t count_elements(const cau_tissue *tissue)
{
	return tissue->tetrahedron_count + tissue->triangle_count + tissue->link_count +
	       tissue->hinge_count;
}

// True if iteration k is the last that the step may take.
static bool is_last(const cau_step_solver *solver, int32_t k)
{
	int64_t spent =
		(k + 2) * (int64_t)count_elements(solver->tissue) + CAU_NEWTON_COST * solver->loose.work;
	if (k + 1 < solver->settings.iterations)
		return false;
	return solver->accuracy.wanted == 0 || k + 1 >= CAU_ACCURACY_STEPS || spent > CAU_SOLVER_EFFORT;
}

// One iteration. Returns true if the round ends.
static bool iterate(cau_step_solver *solver, descent *d, int32_t k, cau_status *status,
                    cau_error *error)
{
	if (k)
		find_increment(solver);
	else
		find_first_increment(solver, &d->objective);
	double norm = step_norm(solver);
	if (!isfinite(norm) || !isfinite(d->objective)) {
		*status =
			cau_fail(error, CAU_NUMERICAL, NULL, "the state is not finite after %d iterations", k);
		return true;
	}
	if (!k)
		d->first = norm;
	solver->result.residual = d->first > 0 ? norm / d->first : 0;
	solver->result.iterations = k + 1;
	if (norm == 0 || (k && solver->result.residual <= solver->settings.tolerance))
		return true;
	bool accelerated = mix(solver, d, k, norm);
	if (meets_others(solver))
		cau_accuracy_begin(&solver->accuracy);
	d->near = cau_accuracy_is_reached(solver, norm) && !touches_elsewhere(solver);
	bool ends = (d->near && solver->loose.settled) || is_last(solver, k);
	return (ends && spare(solver, d, norm)) ||
	       advance(solver, d, k, accelerated, norm, status, error);
}

cau_status cau_solver_descend(cau_step_solver *solver, cau_error *error)
{
	CAU_ASSERT(solver->settings.iterations > 0, "%d iterations", solver->settings.iterations);
	descent d = {.objective = solver->result.objective,
	             .backtracks_before = solver->result.backtracks};
	d.touching = solver->collide ? solver->collide->result.touching_hash : 0;
	solver->result.spared = false;
	forget_increments(solver);
	cau_status status = cau_loose_choose(solver, error);
	if (status)
		return status;
	// If the guess moves tissue into tissue, the energy may exceed the energy at the tick's start.
	if (solver->collide && solver->collide->result.energy_j > solver->collide->start_energy_j)
		go_back(solver, &d.objective);
	for (int32_t k = 0; !iterate(solver, &d, k, &status, error) && !is_last(solver, k);)
		k++;
	if (status)
		return status;
	CAU_ASSERT(solver->result.backtracks - d.backtracks_before <=
	               solver->result.iterations * (CAU_MAX_BACKTRACKS + 1),
	           "%d backtracks in %d iterations", solver->result.backtracks - d.backtracks_before,
	           solver->result.iterations);
	cau_accuracy_learn(&solver->accuracy);
	if (solver->accuracy.wanted > 0)
		solver->accuracy.error = fmax(solver->accuracy.error, solver->loose.left);
	solver->result.objective = d.objective;
	cau_solver_displace(solver);
	return CAU_OK;
}
