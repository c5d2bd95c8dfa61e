// SPDX-License-Identifier: GPL-3.0-or-later
// The step as tissue against tissue allows it: between the solver's reals and the room collide.
#include "cautery/assert.h"
#include "solve/solver.h"

bool cau_solver_keep_apart(cau_step_solver *solver, const double *from)
{
	cau_collide *collide = solver->collide;
	const cau_vectors *vectors = solver->kernels->vectors;
	const cau_surface_parts *surface = &collide->surface.vertices;
	CAU_ASSERT(collide->surface.listed, "%d vertices drawn", surface->count);
	for (int32_t k = 0; k < surface->count; k++)
		vectors->read(solver->trial_increment, surface->item[k],
		              collide->step + 3 * (size_t)surface->item[k]);
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
