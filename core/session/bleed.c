// SPDX-License-Identifier: GPL-3.0-or-later
// Connects a session to its blood vessels (core/vessel).
#include "cautery/assert.h"
#include "session/session_internal.h"

cau_status cau_session_make_vessels(cau_session *session, cau_error *error)
{
	if (!session->scene->vessel_count)
		return CAU_OK;
	CAU_ASSERT(session->heat.cells, "vessels without cells of tissue");
	session->vessels = cau_arena_array(&session->memory.arena, 1, sizeof *session->vessels);
	if (!session->vessels)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for vessels");
	return cau_vessels_create(session->vessels, &session->tissue, session->scene,
	                          &session->memory.arena, error);
}

static cau_vessel_surroundings surroundings(const cau_session *session)
{
	return (cau_vessel_surroundings){
		.cells = session->heat.cells,
		.alive = session->dissection.alive.element[CAU_ELEMENT_TETRAHEDRON],
		.vertex_visible = session->view.frame.vertex_visible,
		.position = session->vertices.position,
		.gravity_m_s2 = session->scene->gravity_m_s2,
		.step_s = session->solver.step_s,
	};
}

void cau_session_look_at_vessels(cau_session *session)
{
	if (!session->vessels)
		return;
	cau_vessel_surroundings around = surroundings(session);
	cau_vessels_look(session->vessels, &around);
}

void cau_session_bleed(cau_session *session)
{
	if (!session->vessels)
		return;
	cau_vessel_surroundings around = surroundings(session);
	cau_vessels_step(session->vessels, &around);
}

bool cau_session_bleeds(const cau_session *session)
{
	return session->vessels && cau_vessels_flow(session->vessels);
}
