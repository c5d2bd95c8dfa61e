// SPDX-License-Identifier: GPL-3.0-or-later
// The global step: increment = -A^-1 gradient, corrected for tissue contact and for tools.
#include "solve/contact.h"
#include "solve/solver.h"

void cau_solver_global(cau_step_solver *solver)
{
	if (solver->contact)
		cau_contact_load(solver->contact, solver);
	cau_solver_apply_inverse(solver, solver->iterate.gradient, solver->iterate.increment, -1);
	if (solver->collide && solver->collide->result.touching_count)
		cau_solver_yield(solver);
	double start = solver->now_s ? solver->now_s() : 0;
	if (solver->contact)
		cau_contact_correct(solver->contact, solver);
	if (solver->now_s)
		solver->result.contact_s += solver->now_s() - start;
}
