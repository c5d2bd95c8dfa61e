// SPDX-License-Identifier: GPL-3.0-or-later
// The step as tissue against tissue allows it: between the solver's reals and the room collide.
#include "cautery/assert.h"
#include "solve/solver.h"

static void read_step(cau_step_solver *solver, int32_t vertex)
{
	solver->kernels->vectors->read(solver->trial_increment, vertex,
	                               solver->collide->step + 3 * (size_t)vertex);
}

// Whether the step passes as it is, which few of its vertices tell.
static bool passes(cau_step_solver *solver, const double *from)
{
	cau_collide *collide = solver->collide;
	double longest =
		solver->kernels->vectors->longest(solver->trial_increment, solver->tissue->vertex_count);
	if (!cau_collide_foresee(collide, longest))
		return false;
	for (int32_t k = 0; k < collide->unclear_count; k++)
		for (int i = 0; i < 4; i++)
			read_step(solver, collide->pair[collide->unclear[k]].vertex[i]);
	return cau_collide_lets_pass(collide, from, longest);
}

bool cau_solver_keep_apart(cau_step_solver *solver, const double *from)
{
	cau_collide *collide = solver->collide;
	const cau_vectors *vectors = solver->kernels->vectors;
	const cau_surface_parts *surface = &collide->surface.vertices;
	CAU_ASSERT(collide->surface.listed, "%d vertices drawn", surface->count);
	if (passes(solver, from))
		return false;
	for (int32_t k = 0; k < surface->count; k++)
		read_step(solver, surface->item[k]);
	if (!cau_collide_filter(collide, solver->pool, from, false))
		return false;
	for (int32_t k = 0; k < surface->count; k++) {
		int32_t v = surface->item[k];
		double change[3];
		vectors->read(solver->trial_increment, v, change);
		for (int c = 0; c < 3; c++)
			change[c] = collide->step[3 * (size_t)v + (size_t)c] - change[c];
		vectors->add(solver->trial_increment, v, change);
	}
	return true;
}
