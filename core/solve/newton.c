// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/newton.h"

#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"
#include "solve/solver.h"

bool cau_newton_is_called_for(const cau_step_solver *solver)
{
	return solver->newton_chosen && (!solver->contact || !solver->contact->row_count) &&
	       (!solver->collide || !solver->collide->touching_count);
}

// By row, and back: the gradient of a fixed vertex is 0, and so is what comes of it.
static void take_gradient(cau_newton *newton, const cau_step_solver *solver)
{
	for (int32_t v = 0; v < solver->tissue->vertex_count; v++) {
		if (newton->place[v] < 0)
			continue;
		double *to = newton->field + 4 * (int64_t)newton->place[v];
		solver->kernels->vectors->read(solver->gradient, v, to);
		for (int c = 0; c < 3; c++)
			to[c] = -to[c];
		to[3] = 0;
	}
}

static void give_increment(const cau_newton *newton, cau_step_solver *solver)
{
	size_t count = 4 * (size_t)solver->tissue->vertex_count;
	memset(solver->increment, 0, count * solver->kernels->vectors->real_bytes);
	for (int32_t v = 0; v < solver->tissue->vertex_count; v++)
		if (newton->place[v] >= 0 && !solver->fixed[v])
			solver->kernels->vectors->add(solver->increment, v,
			                              newton->field + 4 * (int64_t)newton->place[v]);
}

cau_status cau_newton_increment(cau_step_solver *solver, cau_error *error)
{
	cau_newton *newton = &solver->newton;
	CAU_ASSERT(solver->newton_chosen, "Newton's step of %d tetrahedra",
	           solver->tissue->tetrahedron_count);
	if (!newton->n) {
		cau_status status = cau_newton_create(newton, solver, error);
		if (status)
			return status;
	}
	cau_newton_assemble(newton, solver);
	if (!solver->kernels->newton_factor(newton))
		return cau_fail(error, CAU_NUMERICAL, NULL, "a sheet's Hessian is not positive definite");
	take_gradient(newton, solver);
	solver->kernels->newton_solve(newton);
	give_increment(newton, solver);
	return CAU_OK;
}
