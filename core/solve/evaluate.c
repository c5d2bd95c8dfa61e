// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient and value of eq. 4: inertia, elements, drag.
#include "base/vector.h"
#include "cautery/assert.h"
#include "solve/solver.h"

void cau_solver_displace_chunk(cau_step_solver *solver, int32_t chunk)
{
	CAU_ASSERT_INDEX(chunk, solver->chunk_count);
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK;
	if (last > solver->tissue->vertex_count)
		last = solver->tissue->vertex_count;
	const double *x = solver->position, *rest = solver->tissue->rest;
	if (solver->elements.single) {
		float *u = solver->displacement;
		for (int32_t v = first; v < last; ++v)
			for (int c = 0; c < 3; ++c)
				u[4 * v + c] = (float)(x[3 * v + c] - rest[3 * v + c]);
	} else {
		double *u = solver->displacement;
		for (int32_t v = first; v < last; ++v)
			for (int c = 0; c < 3; ++c)
				u[4 * v + c] = x[3 * v + c] - rest[3 * v + c];
	}
}

static void displacement_part(void *context, int32_t chunk)
{
	cau_solver_displace_chunk(context, chunk);
}

static void local_part(void *context, int32_t index)
{
	cau_step_solver *solver = context;
	CAU_ASSERT_INDEX(index, solver->slots.work_count);
	solver->kernels->local(&solver->elements, &solver->slots.work[index], solver->displacement,
	                       solver->diagonal);
}

// Adds inertia m/dt^2 (x - s) to the chunk's gradient and returns its energy.
#define ADD_INERTIA(real)                                                                          \
	static double add_inertia_##real(const cau_step_solver *solver, int32_t first, int32_t last)   \
	{                                                                                              \
		double energy = 0, scale = 1 / (solver->step_s * solver->step_s);                          \
		const double *x = solver->position, *s = solver->predicted;                                \
		real *gradient = solver->gradient;                                                         \
		for (int32_t v = first; v < last; ++v) {                                                   \
			double m = scale * solver->tissue->mass[v], free = !solver->fixed[v];                  \
			for (int c = 0; c < 3; ++c) {                                                          \
				double away = x[3 * v + c] - s[3 * v + c];                                         \
				energy += m * away * away;                                                         \
				gradient[4 * v + c] = (real)(free * ((double)gradient[4 * v + c] + m * away));     \
			}                                                                                      \
		}                                                                                          \
		return energy / 2;                                                                         \
	}
ADD_INERTIA(float)
ADD_INERTIA(double)

static void vertex_part(void *context, int32_t chunk)
{
	cau_step_solver *solver = context;
	CAU_ASSERT_INDEX(chunk, solver->chunk_count);
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK;
	if (last > solver->tissue->vertex_count)
		last = solver->tissue->vertex_count;
	solver->kernels->sum(&solver->elements, &solver->slots.incidence, first, last,
	                     solver->gradient);
	solver->chunk_energy[chunk] = solver->elements.single ? add_inertia_float(solver, first, last)
	                                                      : add_inertia_double(solver, first, last);
}

static double add_drag(cau_step_solver *solver)
{
	double energy = 0;
	int single = solver->elements.single;
	for (int32_t k = 0; k < solver->drag_count; ++k) {
		const cau_drag *drag = &solver->drag[k];
		CAU_ASSERT_INDEX(drag->vertex, solver->tissue->vertex_count);
		CAU_ASSERT(drag->coefficient >= 0, "a drag of %g N/m", drag->coefficient);
		if (solver->fixed[drag->vertex])
			continue;
		for (int c = 0; c < 3; ++c) {
			int64_t i = 4 * (int64_t)drag->vertex + c;
			double away = solver->position[3 * drag->vertex + c] - drag->target[c];
			energy += drag->coefficient * away * away / 2;
			cau_real_set(solver->gradient, single, i,
			             cau_real_get(solver->gradient, single, i) + drag->coefficient * away);
		}
	}
	return energy;
}

double cau_solver_elastic_energy(const cau_step_solver *solver)
{
	double energy = 0;
	for (int32_t w = 0; w < solver->slots.work_count; ++w)
		energy += solver->elements.energy[w];
	return energy;
}

void cau_solver_displace(cau_step_solver *solver)
{
	cau_pool_run(solver->pool, solver->chunk_count, displacement_part, solver);
}

double cau_solver_evaluate(cau_step_solver *solver)
{
	cau_solver_displace(solver);
	return cau_solver_evaluate_displaced(solver);
}

// The local step with something else as its first part, which the caller of the pool takes.
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

// The rest, after the local step that began at `start` seconds.
static double gather(cau_step_solver *solver, double start)
{
	// sums over each vertex's records, plus inertia and drag
	cau_pool_run(solver->pool, solver->chunk_count, vertex_part, solver);
	double energy = cau_solver_elastic_energy(solver);
	for (int32_t k = 0; k < solver->chunk_count; ++k)
		energy += solver->chunk_energy[k];
	energy += add_drag(solver);
	if (solver->now_s)
		solver->local_s += solver->now_s() - start;
	return energy;
}

double cau_solver_evaluate_displaced(cau_step_solver *solver)
{
	double start = solver->now_s ? solver->now_s() : 0;
	// local step: every element projected, its gradient recorded
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
