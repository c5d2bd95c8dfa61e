// SPDX-License-Identifier: GPL-3.0-or-later
// The global step with tissue contact. A does not contain the stiffness K between touching tissue.
// If tissue lies on something light, a step by A alone would move the light tissue far away. So the
// step uses A + K: conjugate gradients with A^-1 as preconditioner, which costs a few more sweeps.
// Here z = A^-1 r, and directions p are sums of z's, so A p is a sum of r's. So no product with A
// is needed.
#include <string.h>

#include "cautery/assert.h"
#include "solve/solver.h"

// Least r.z, as a share of the first r.z, for another step of conjugate gradients.
static const double enough = 0.01;
// Share of `enough`. If r.z is predicted instead of computed, it must be below this share.
static const double surely = 0.5;
enum { MOST_SWEEPS = 12 };

cau_status cau_solver_make_yield(cau_step_solver *solver, cau_arena *arena, cau_error *error)
{
	size_t count = 4 * (size_t)solver->tissue->vertex_count;
	cau_reals **vectors[] = {&solver->yield.residual, &solver->yield.solved,
	                         &solver->yield.direction, &solver->yield.image};
	for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
		if (!(*vectors[i] = cau_arena_array(arena, count, solver->kernels->vectors->real_bytes)))
			return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for tissue against tissue");
	return CAU_OK;
}

// to += scale * from
static void add(cau_step_solver *solver, cau_reals *to, double scale, const cau_reals *from)
{
	solver->kernels->add_scaled(to, scale, from, 4 * (int64_t)solver->tissue->vertex_count);
}

// to = from + scale * to
static void turn(cau_step_solver *solver, cau_reals *to, double scale, const cau_reals *from)
{
	add(solver, to, scale - 1, to);
	add(solver, to, 1, from);
}

typedef struct product {
	cau_step_solver *solver;
	const cau_reals *a, *b;
} product;

static void product_part(void *context, int32_t chunk)
{
	const product *work = context;
	cau_step_solver *solver = work->solver;
	int32_t first, last = cau_solver_chunk_end(solver, chunk, &first);
	solver->chunks.dot[chunk] =
		solver->kernels->dot(work->a, work->b, 4 * (int64_t)first, 4 * (int64_t)(last - first));
}

static double dot(cau_step_solver *solver, const cau_reals *a, const cau_reals *b)
{
	double all = 0;
	cau_pool_run(solver->pool, solver->chunks.count, product_part, &(product){solver, a, b});
	for (int32_t chunk = 0; chunk < solver->chunks.count; chunk++)
		all += solver->chunks.dot[chunk];
	return all;
}

// Returns direction . K direction. Stores K direction in collide->answer, for vertices in contact.
static double touch(cau_step_solver *solver, const cau_reals *direction)
{
	cau_collide *collide = solver->collide;
	double along = 0;
	for (int32_t k = 0; k < collide->load.count; k++)
		solver->kernels->vectors->read(direction, collide->load.vertex[k],
		                               collide->load.probe + 3 * (size_t)collide->load.vertex[k]);
	cau_collide_apply(collide);
	for (int32_t k = 0; k < collide->load.count; k++) {
		size_t at = 3 * (size_t)collide->load.vertex[k];
		for (size_t i = at; i < at + 3; i++)
			along += collide->load.probe[i] * collide->load.answer[i];
	}
	return along;
}

// residual -= scale * K direction
static void take_off(cau_step_solver *solver, double scale)
{
	const cau_collide *collide = solver->collide;
	for (int32_t k = 0; k < collide->load.count; k++) {
		int32_t v = collide->load.vertex[k];
		const double *force = collide->load.answer + 3 * (size_t)v;
		if (!solver->fixed[v])
			solver->kernels->vectors->add(
				solver->yield.residual, v,
				(double[]){-scale * force[0], -scale * force[1], -scale * force[2]});
	}
}

// True if one step of conjugate gradients is enough. `stiffer` is p.K p over p.A p. The part of r.z
// that the first step leaves is at most `stiffer` times the largest eigenvalue of A^-1 K. The
// steepest pair gives an estimate of that eigenvalue: before a pair is pressed, it is about as
// stiff as A at its vertices.
static bool first_serves(const cau_step_solver *solver, double stiffer)
{
	return stiffer * solver->collide->result.steepest <= surely * enough;
}

// True if the last step was enough. The decrease of E is assumed to shrink from step to step at
// least as much as at the last step. off[0] is the decrease in J by the first step, off[1] by the
// step before the last, off[2] by the last step.
static bool last_served(const double off[3])
{
	return off[2] * off[2] <= surely * enough * off[0] * off[1];
}

static void begin(cau_step_solver *solver)
{
	cau_yield *y = &solver->yield;
	size_t bytes = 4 * (size_t)solver->tissue->vertex_count * solver->kernels->vectors->real_bytes;
	// sets r = -gradient, and z = p = A^-1 r, which is the present increment; then A p = r
	memset(y->residual, 0, bytes);
	add(solver, y->residual, -1, solver->iterate.gradient);
	memcpy(y->image, y->residual, bytes);
	memcpy(y->direction, solver->iterate.increment, bytes);
	memset(solver->iterate.increment, 0, bytes);
}

void cau_solver_yield(cau_step_solver *solver)
{
	cau_yield *y = &solver->yield;
	CAU_ASSERT(y->residual != NULL, "%d parts touch", solver->collide->result.touching_count);
	double size = -dot(solver, solver->iterate.gradient, solver->iterate.increment), first = size,
		   off[3] = {0};
	double touching = touch(solver, solver->iterate.increment), own = size;
	if (!(size > 0) || !(touching >= 0))
		return;
	if (first_serves(solver, touching / own)) {
		add(solver, solver->iterate.increment, size / (touching + own) - 1,
		    solver->iterate.increment);
		return;
	}
	begin(solver);
	for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
		double step = size / (touching + own);
		add(solver, solver->iterate.increment, step, y->direction);
		off[1] = sweep ? off[2] : step * size;
		off[2] = step * size;
		if (!sweep)
			off[0] = off[2];
		else if (last_served(off))
			return;
		add(solver, y->residual, -step, y->image);
		take_off(solver, step);
		cau_solver_apply_inverse(solver, y->residual, y->solved, 1);
		double next = dot(solver, y->residual, y->solved);
		if (!(next > enough * first))
			return;
		turn(solver, y->direction, next / size, y->solved);
		turn(solver, y->image, next / size, y->residual);
		size = next;
		touching = touch(solver, y->direction);
		own = dot(solver, y->direction, y->image);
		if (!(touching + own > 0))
			return;
	}
}
