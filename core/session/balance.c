// SPDX-License-Identifier: GPL-3.0-or-later
// Total mechanical quantities (momentum, forces, energies), for tests and plots.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

static cau_vec3 elastic_gradient(const cau_session *session, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, session->tissue.vertex_count);
	// The solver's gradient vector holds a plain sum of the element records here.
	double g[3];
	session->solver.kernels->vectors->read(session->solver.iterate.gradient, vertex, g);
	return cau_vec3_of(g);
}

// Copies the elements' rotations to `kept`, or with `restore` from `kept` to the elements. The
// elements keep these rotations between evaluations, and the next step starts from them. Returns
// the number of copied bytes.
static size_t pass_polars(void *const *polar, int arrays, size_t array_bytes, char *kept,
                          bool restore)
{
	for (int i = 0; i < arrays && array_bytes > 0; i++) {
		char *other = kept + (size_t)i * array_bytes;
		memcpy(restore ? polar[i] : other, restore ? other : polar[i], array_bytes);
	}
	return (size_t)arrays * array_bytes;
}

// Copies the rotations of all elements. The caller frees them. NULL if memory ran out.
static char *keep_polars(const cau_elements *elements)
{
	size_t real = cau_real_bytes(elements->single);
	size_t sheet = (size_t)elements->sheet.slot_count * real;
	size_t fat = (size_t)elements->fat.slot_count * real;
	char *kept = malloc(6 * sheet + 4 * fat + 1);
	if (kept)
		pass_polars(elements->fat.polar, 4, fat,
		            kept + pass_polars(elements->sheet.polar, 6, sheet, kept, false), false);
	return kept;
}

static void return_polars(const cau_elements *elements, char *kept)
{
	size_t real = cau_real_bytes(elements->single);
	size_t sheet = (size_t)elements->sheet.slot_count * real;
	size_t fat = (size_t)elements->fat.slot_count * real;
	pass_polars(elements->fat.polar, 4, fat,
	            kept + pass_polars(elements->sheet.polar, 6, sheet, kept, true), true);
	free(kept);
}

cau_status cau_session_balance(cau_session *session, cau_balance *balance)
{
	cau_step_solver *solver = &session->solver;
	const cau_tissue *tissue = &session->tissue;
	*balance = (cau_balance){0};
	char *polars = keep_polars(&solver->elements);
	if (!polars)
		return CAU_NO_MEMORY;
	// Residual of eq. 4 at the present state, with the present contact reactions.
	cau_solver_evaluate(solver);
	return_polars(&solver->elements, polars);
	for (int32_t i = 0; i < session->contact.row_count; i++) {
		const cau_contact_row *row = &session->contact.row[i];
		for (int32_t k = 0; k < row->corner_count; k++) {
			double off[3];
			for (int c = 0; c < 3; c++)
				off[c] = -row->weight[k] * row->reaction[c];
			solver->kernels->vectors->add(solver->iterate.gradient, row->vertex[k], off);
		}
	}
	double squared = 0;
	for (int32_t v = 0; v < tissue->vertex_count; v++)
		squared += cau_dot(elastic_gradient(session, v), elastic_gradient(session, v));
	balance->residual_n = sqrt(squared);
	// The gradient of the elements alone.
	solver->kernels->sum(&solver->elements, &solver->slots.incidence, 0, tissue->vertex_count,
	                     solver->iterate.gradient);
	balance->elastic_j = cau_solver_elastic_energy(solver);
	cau_vec3 gravity = cau_vec3_of(session->scene->gravity_m_s2);
	cau_vec3 momentum = {0, 0, 0}, force = {0, 0, 0}, torque = {0, 0, 0};
	for (int32_t v = 0; v < tissue->vertex_count; v++) {
		cau_vec3 x = cau_vec3_of(session->vertices.position + 3 * (size_t)v);
		cau_vec3 velocity = cau_vec3_of(session->vertices.velocity + 3 * (size_t)v);
		cau_vec3 f = cau_scale(-1, elastic_gradient(session, v));
		momentum = cau_add_scaled(momentum, tissue->mass[v], velocity);
		force = cau_add(force, f);
		torque = cau_add(torque, cau_cross(x, f));
		balance->force_sum += cau_length(f);
		balance->torque_sum += cau_length(x) * cau_length(f);
		balance->kinetic_j += tissue->mass[v] * cau_dot(velocity, velocity) / 2;
		balance->gravitational_j -= tissue->mass[v] * cau_dot(gravity, x);
	}
	cau_vec3_to(momentum, balance->momentum);
	cau_vec3_to(force, balance->net_force);
	cau_vec3_to(torque, balance->net_torque);
	return CAU_OK;
}
