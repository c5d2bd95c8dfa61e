// SPDX-License-Identifier: GPL-3.0-or-later
// Supports of the tissue: pinned vertices, with the systems that depend on them, and pinned
// vertices that move.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- pins

// Changes of pinned vertices at run time. Pinned vertices have no rows in the system, so a new set
// of pins changes the pattern of the matrix. The system is analysed and factored again within the
// tick. This takes tens of milliseconds for 30,000 tetrahedra, once for each change.

cau_status cau_session_rebuild_system(cau_session *session, cau_error *error)
{
	CAU_ASSERT(session->contact.solution != NULL, "a system of %d vertices before its contacts",
	           session->tissue.vertex_count);
	cau_step_solver *solver = &session->solver;
	cau_matrix_update_finish(&session->update);
	cau_solver_finish(solver);
	memset(&session->update, 0, sizeof session->update);
	// a system without rows was marked as diagonal; use the scene's choice again
	solver->settings.diagonal = session->scene->solver == CAU_SOLVER_DIAGONAL;
	solver->age.version++;
	solver->age.epoch++;
	// A pinned vertex has no row any more. From now on nothing writes its part of these arrays.
	size_t bytes = 4 * (size_t)session->tissue.vertex_count * solver->kernels->vectors->real_bytes;
	memset(solver->iterate.increment, 0, bytes);
	memset(solver->anderson.history.last_increment, 0, bytes);
	memset(session->contact.solution, 0, bytes);
	// Frees the last rebuilt system. However often pins change, a session holds at most two
	// systems.
	cau_arena *arena = &session->memory.rebuilt;
	cau_arena_finish(arena);
	cau_status status = cau_system_create(&solver->system, &session->tissue,
	                                      session->vertices.pinned, arena, error);
	if (!status)
		status = cau_solver_factor(solver, &session->dissection.alive, NULL, arena, error);
	if (!status)
		status = cau_matrix_update_create(&session->update, solver, &session->dissection.alive,
		                                  arena, error);
	return status;
}

cau_status cau_session_set_pins(cau_session *session, const cau_selection *selection, int pin,
                                cau_error *error)
{
	CAU_ASSERT(pin == 0 || pin == 1, "pinned: %d", pin);
	size_t n = (size_t)session->tissue.vertex_count;
	cau_vertices *vertices = &session->vertices;
	memset(vertices->chosen, 0, n);
	if (cau_tissue_select(&session->tissue, selection, vertices->chosen) <= 0)
		return cau_fail(error, CAU_NOT_FOUND, "selection", "no vertex lies in this selection");
	bool changed = false;
	for (size_t v = 0; v < n; v++)
		if (vertices->chosen[v] && vertices->pinned[v] != pin) {
			changed = true;
			bool was_frozen = vertices->fixed[v] && !vertices->pinned[v];
			vertices->pinned[v] = (uint8_t)pin;
			vertices->fixed[v] = (uint8_t)(pin || !session->dissection.live_elements[v]);
			vertices->frozen_count += (vertices->fixed[v] && !pin) - was_frozen;
			memset(vertices->velocity + 3 * v, 0, 3 * sizeof(double));
		}
	if (!changed)
		return CAU_OK;
	cau_session_drop_frozen_grasps(session);
	return cau_session_rebuild_system(session, error);
}

// ---- moving supports

// Moving supports: pinned vertices that follow positions given by the caller, tick by tick.

static const double farthest_m = 1000; // m; the limit of all positions in the input

static cau_status check_driven(const cau_session *session, int32_t vertex, const double at[3],
                               cau_error *error)
{
	if (vertex < 0 || vertex >= session->tissue.vertex_count)
		return cau_fail(error, CAU_BAD_VALUE, "vertices", "there is no vertex %d", vertex);
	if (!session->vertices.pinned[vertex])
		return cau_fail(error, CAU_BAD_STATE, "vertices", "vertex %d is not pinned", vertex);
	for (int c = 0; c < 3; c++)
		if (!(fabs(at[c]) <= farthest_m))
			return cau_fail(error, CAU_BAD_VALUE, "position_m", "%g is not within %g m", at[c],
			                farthest_m);
	return CAU_OK;
}

cau_status cau_session_drive(cau_session *session, int32_t count, const int32_t *vertex,
                             const double *position, cau_error *error)
{
	if (count < 0 || count > session->tissue.vertex_count)
		return cau_fail(error, CAU_BAD_VALUE, "count", "%d of %d vertices", count,
		                session->tissue.vertex_count);
	cau_status status = CAU_OK;
	for (int32_t k = 0; k < count && !status; k++)
		status = check_driven(session, vertex[k], position + 3 * (size_t)k, error);
	if (status || !count)
		return status;
	memcpy(session->driven.vertex, vertex, (size_t)count * sizeof *vertex);
	memcpy(session->driven.position, position, 3 * (size_t)count * sizeof *position);
	session->driven.count = count;
	return CAU_OK;
}

void cau_session_lead_driven(cau_session *session)
{
	CAU_ASSERT(session->driven.count >= 0 && session->driven.count <= session->tissue.vertex_count,
	           "%d vertices led of %d", session->driven.count, session->tissue.vertex_count);
	const cau_substep *substep = &session->substep;
	bool last = substep->index == substep->count - 1;
	for (int32_t k = 0; k < session->driven.count; k++) {
		int32_t vertex = session->driven.vertex[k];
		double *at = session->vertices.position + 3 * (size_t)vertex;
		const double *to = session->driven.position + 3 * (size_t)k;
		if (!session->vertices.pinned[vertex]) // a command of this tick has unpinned the vertex
			continue;
		for (int c = 0; c < 3; c++)
			at[c] = last ? to[c] : at[c] + substep->part * (to[c] - at[c]);
	}
	if (last)
		session->driven.count = 0;
}
