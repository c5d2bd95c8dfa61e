// SPDX-License-Identifier: GPL-3.0-or-later
// Limits a step so that tissue does not cross tissue: connects the solver's arrays with
// core/collide.
#include <math.h>

#include "cautery/assert.h"
#include "solve/solver.h"

static void read_step(cau_step_solver *solver, int32_t vertex)
{
	solver->kernels->vectors->read(solver->iterate.trial, vertex,
	                               solver->collide->step + 3 * (size_t)vertex);
}

// True if no pair of tissue crosses in the unchanged step. Only vertices of pairs that may cross
// are checked.
static bool passes(cau_step_solver *solver, const double *from)
{
	cau_collide *collide = solver->collide;
	double longest =
		solver->kernels->vectors->longest(solver->iterate.trial, solver->tissue->vertex_count);
	if (!cau_collide_foresee(collide, longest))
		return false;
	for (int32_t k = 0; k < collide->filter.unclear_count; k++)
		for (int i = 0; i < 4; i++)
			read_step(solver, collide->pair[collide->filter.unclear[k]].vertex[i]);
	return cau_collide_lets_pass(collide, from, longest);
}

// The largest motion, m, of a vertex that takes part in tissue contact.
static double longest_drawn(const cau_step_solver *solver, const cau_reals *step)
{
	const cau_collide *collide = solver->collide;
	const cau_surface_parts *surface = &collide->surface.vertices;
	double longest2 = 0, way[3];
	for (int32_t k = 0; k < surface->count; k++) {
		if (collide->exempt[surface->item[k]])
			continue;
		solver->kernels->vectors->read(step, surface->item[k], way);
		longest2 = fmax(longest2, cau_dot(cau_vec3_of(way), cau_vec3_of(way)));
	}
	return sqrt(longest2);
}

// Least length of a step that is first shortened as a whole, relative to the longest step that the
// filter allows. The filter shortens steps vertex by vertex. Without the first shortening, a much
// longer step might no longer lower the energy after the filter, and might invert tissue.
static const double much_longer = 2;

static bool shorten(cau_step_solver *solver)
{
	const cau_vectors *vectors = solver->kernels->vectors;
	int32_t n = solver->tissue->vertex_count;
	double most = much_longer * cau_collide_most_step(solver->collide);
	if (!(vectors->longest(solver->iterate.trial, n) > most))
		return false;
	double longest = longest_drawn(solver, solver->iterate.trial);
	if (!(longest > most))
		return false;
	solver->kernels->add_scaled(solver->iterate.trial, most / longest - 1, solver->iterate.trial,
	                            4 * (int64_t)n);
	return true;
}

bool cau_solver_let_go(cau_step_solver *solver)
{
	cau_collide *collide = solver->collide;
	const cau_surface_parts *surface = &collide->surface.vertices;
	double step = cau_collide_most_step(collide), way[3];
	if (!(longest_drawn(solver, solver->iterate.increment) > solver->settings.iterations * step))
		return false;
	for (int32_t k = 0; k < surface->count; k++) {
		int32_t v = surface->item[k];
		solver->kernels->vectors->read(solver->iterate.increment, v, way);
		if (!collide->exempt[v] && cau_length(cau_vec3_of(way)) > much_longer * step)
			cau_collide_let_go(collide, v);
	}
	collide->cut_short_count++;
	return true;
}

static bool filter(cau_step_solver *solver, const double *from)
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
		vectors->read(solver->iterate.trial, v, change);
		for (int c = 0; c < 3; c++)
			change[c] = collide->step[3 * (size_t)v + (size_t)c] - change[c];
		vectors->add(solver->iterate.trial, v, change);
	}
	return true;
}

bool cau_solver_keep_apart(cau_step_solver *solver, const double *from)
{
	bool shorter = shorten(solver), changed = filter(solver, from);
	if (shorter && !changed) {
		solver->collide->filter.held_back = true;
		solver->collide->held_back_count++;
	}
	return shorter || changed;
}
