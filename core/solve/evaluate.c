// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient and value of eq. 4: inertia, elements, drag and tissue contact.
#include "base/vector.h"
#include "cautery/assert.h"
#include "solve/solver.h"

static void displacement_part(void *context, int32_t chunk)
{
	const cau_step_solver *solver = context;
	int32_t first, last = cau_solver_chunk_end(solver, chunk, &first);
	solver->kernels->vectors->displace(solver, first, last);
}

static void local_part(void *context, int32_t index)
{
	cau_step_solver *solver = context;
	CAU_ASSERT_INDEX(index, solver->slots.work_count);
	solver->kernels->local(&solver->elements, &solver->slots.work[index],
	                       solver->iterate.displacement, solver->settings.diagonal);
}

static void vertex_part(void *context, int32_t chunk)
{
	cau_step_solver *solver = context;
	int32_t first, last = cau_solver_chunk_end(solver, chunk, &first);
	solver->kernels->sum(&solver->elements, &solver->slots.incidence, first, last,
	                     solver->iterate.gradient);
	solver->chunks.energy[chunk] = solver->kernels->vectors->add_inertia(solver, first, last);
}

static double add_drag(cau_step_solver *solver)
{
	double energy = 0;
	for (int32_t k = 0; k < solver->forces.drag_count; k++) {
		const cau_drag *drag = &solver->forces.drag[k];
		CAU_ASSERT_INDEX(drag->vertex, solver->tissue->vertex_count);
		CAU_ASSERT(drag->coefficient >= 0, "a drag of %g N/m", drag->coefficient);
		if (solver->fixed[drag->vertex])
			continue;
		double pull[3];
		for (int c = 0; c < 3; c++) {
			double away = solver->position[3 * drag->vertex + c] - drag->target[c];
			energy += drag->coefficient * away * away / 2;
			pull[c] = drag->coefficient * away;
		}
		solver->kernels->vectors->add(solver->iterate.gradient, drag->vertex, pull);
	}
	return energy;
}

static double add_collisions(cau_step_solver *solver)
{
	cau_collide *collide = solver->collide;
	double energy = cau_collide_evaluate(collide, solver->pool, solver->position);
	for (int32_t k = 0; k < collide->load.count; k++) {
		int32_t v = collide->load.vertex[k];
		CAU_ASSERT_INDEX(v, solver->tissue->vertex_count);
		if (!solver->fixed[v])
			solver->kernels->vectors->add(solver->iterate.gradient, v,
			                              collide->load.gradient + 3 * (size_t)v);
	}
	return energy;
}

typedef struct strain_work {
	const cau_step_solver *solver;
	double share;
} strain_work;

double cau_solver_viscous_energy(const cau_step_solver *solver)
{
	double energy = 0;
	for (int32_t w = 0; w < solver->slots.work_count && solver->elements.rate_per_s > 0; w++)
		energy += solver->elements.viscous_j[w];
	return energy;
}

// The sum of the elements' energies, J: laws and viscosity.
static double energy_of_elements(const cau_step_solver *solver)
{
	double energy = 0;
	for (int32_t w = 0; w < solver->slots.work_count; w++)
		energy += solver->elements.energy[w];
	return energy;
}

double cau_solver_elastic_energy(const cau_step_solver *solver)
{
	return energy_of_elements(solver) - cau_solver_viscous_energy(solver);
}

// Returns the change of E, J, that rounding alone can make: the rounding of the sum E, or of the
// residuals R if that is larger. A step may promise a decrease of E that is less than the rounding
// of each element's residual can change. Such a step is judged by the rounding of the residuals.
// With w/2 |R|^2 of N elements that add up to E, w |R| dR is sqrt(2 w E / N) dR in the root mean
// square. In stiff tissue with almost no load this is far more than the rounding of E. If both are
// similar, the rounding of E is used.
double cau_solver_noise(const cau_step_solver *solver, double promise)
{
	double elastic = fabs(cau_solver_elastic_energy(solver));
	double of_sum = solver->kernels->vectors->rounding * elastic;
	// Rounding of a single residual, which is less than that of a sum of thousands of terms.
	double one_term = 0.06 * solver->kernels->vectors->rounding;
	double of_residuals = one_term * sqrt(2 * solver->settings.stiffness_j * elastic);
	// if tissue touches, of_sum is the limit: with a larger one, steps might drive a fold into
	// itself
	if (solver->collide)
		return of_sum;
	return of_residuals > 2 * of_sum && promise < of_residuals ? of_residuals : of_sum;
}

static void strain_part(void *context, int32_t index)
{
	const strain_work *work = context;
	const cau_step_solver *solver = work->solver;
	CAU_ASSERT_INDEX(index, solver->slots.work_count);
	solver->kernels->take_strain(&solver->elements, &solver->slots.work[index],
	                             solver->iterate.displacement, work->share);
}

void cau_solver_take_strain(cau_step_solver *solver, double share)
{
	strain_work work = {solver, share};
	if (!solver->tissue->viscous)
		return;
	cau_solver_displace(solver);
	cau_pool_run(solver->pool, solver->slots.work_count, strain_part, &work);
	solver->elements.rate_per_s = 1 / solver->inertia_s;
}

void cau_solver_displace(cau_step_solver *solver)
{
	cau_pool_run(solver->pool, solver->chunks.count, displacement_part, solver);
}

double cau_solver_evaluate(cau_step_solver *solver)
{
	cau_solver_displace(solver);
	return cau_solver_evaluate_displaced(solver);
}

// The local step, with a call of `meanwhile` as its first part. The thread that calls the pool
// takes this part.
typedef struct shared_local {
	cau_step_solver *solver;
	void (*meanwhile)(void *context);
	void *context;
} shared_local;

static void shared_local_part(void *context, int32_t index)
{
	const shared_local *work = context;
	if (index)
		local_part(work->solver, index - 1);
	else
		work->meanwhile(work->context);
}

// Sums energy and gradient after the local step, which began at `start` seconds.
static double gather(cau_step_solver *solver, double start)
{
	// sums over each vertex's records, plus inertia and drag
	cau_pool_run(solver->pool, solver->chunks.count, vertex_part, solver);
	double energy = energy_of_elements(solver);
	for (int32_t k = 0; k < solver->chunks.count; k++)
		energy += solver->chunks.energy[k];
	energy += add_drag(solver);
	if (solver->collide)
		energy += add_collisions(solver);
	if (solver->now_s)
		solver->result.local_s += solver->now_s() - start;
	return energy;
}

double cau_solver_evaluate_displaced(cau_step_solver *solver)
{
	double start = solver->now_s ? solver->now_s() : 0;
	// local step: project every element, store its gradient
	cau_pool_run(solver->pool, solver->slots.work_count, local_part, solver);
	return gather(solver, start);
}

double cau_solver_evaluate_beside(cau_step_solver *solver, void (*meanwhile)(void *context),
                                  void *context)
{
	shared_local work = {solver, meanwhile, context};
	cau_solver_displace(solver);
	double start = solver->now_s ? solver->now_s() : 0;
	cau_pool_run(solver->pool, solver->slots.work_count + 1, shared_local_part, &work);
	return gather(solver, start);
}
