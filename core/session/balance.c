// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanical totals, for tests and plots.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

static cau_vec3 elastic_gradient(const cau_session *session, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, session->tissue.vertex_count);
	// the solver's gradient vector after a plain sum of the element records
	double g[3];
	session->solver.kernels->vectors->read(session->solver.gradient, vertex, g);
	return cau_vec3_of(g);
}

void cau_session_balance(cau_session *session, cau_balance *balance)
{
	cau_step_solver *solver = &session->solver;
	const cau_tissue *tissue = &session->tissue;
	*balance = (cau_balance){0};
	// residual of eq. 4 at the present state, with the present reactions
	cau_solver_evaluate(solver);
	for (int32_t i = 0; i < session->contact.row_count; i++) {
		const cau_contact_row *row = &session->contact.row[i];
		const double off[3] = {-row->reaction[0], -row->reaction[1], -row->reaction[2]};
		solver->kernels->vectors->add(solver->gradient, row->vertex, off);
	}
	double squared = 0;
	for (int32_t v = 0; v < tissue->vertex_count; v++)
		squared += cau_dot(elastic_gradient(session, v), elastic_gradient(session, v));
	balance->residual_n = sqrt(squared);
	// elements alone
	solver->kernels->sum(&solver->elements, &solver->slots.incidence, 0, tissue->vertex_count,
	                     solver->gradient);
	balance->elastic_j = cau_solver_elastic_energy(solver);
	cau_vec3 momentum = {0, 0, 0}, force = {0, 0, 0}, torque = {0, 0, 0};
	for (int32_t v = 0; v < tissue->vertex_count; v++) {
		cau_vec3 x = cau_vec3_of(session->position + 3 * (size_t)v);
		cau_vec3 velocity = cau_vec3_of(session->velocity + 3 * (size_t)v);
		cau_vec3 f = cau_scale(-1, elastic_gradient(session, v));
		momentum = cau_add_scaled(momentum, tissue->mass[v], velocity);
		force = cau_add(force, f);
		torque = cau_add(torque, cau_cross(x, f));
		balance->force_sum += cau_length(f);
		balance->torque_sum += cau_length(x) * cau_length(f);
		balance->kinetic_j += tissue->mass[v] * cau_dot(velocity, velocity) / 2;
	}
	cau_vec3_to(momentum, balance->momentum);
	cau_vec3_to(force, balance->net_force);
	cau_vec3_to(torque, balance->net_torque);
}
