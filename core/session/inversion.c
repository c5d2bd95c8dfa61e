// SPDX-License-Identifier: GPL-3.0-or-later
// Inverted tetrahedra. A step may leave some, and the next steps usually restore them. The energy
// of StVK has a minimum at an inverted shape, so this law can keep them inverted with every number
// finite. Tetrahedra that stay inverted are counted by layer, and the session reports the counts.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// Time, s, from which on an inversion is counted as long. Inversions of a fast motion last only
// some ticks. An inversion of half a second has another cause.
static const double long_s = 0.5;

cau_status cau_session_make_inversion(cau_session *session, cau_error *error)
{
	cau_inversion *inversion = &session->inversion;
	inversion->ticks =
		cau_arena_array(&session->memory.arena, (size_t)session->tissue.tetrahedron_count + 1,
	                    sizeof *inversion->ticks);
	CAU_ASSERT(session->solver.step_s >= long_s / UINT16_MAX, "steps of %g s",
	           session->solver.step_s);
	inversion->long_ticks = (uint16_t)ceil(long_s / session->solver.step_s);
	return inversion->ticks ? CAU_OK
	                        : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
}

bool cau_session_is_inverted(const double *position, const int32_t vertex[4])
{
	cau_vec3 from = cau_vec3_of(position + 3 * (size_t)vertex[0]), side[3];
	for (int k = 0; k < 3; k++)
		side[k] = cau_sub(cau_vec3_of(position + 3 * (size_t)vertex[k + 1]), from);
	// at rest the volume is positive (mesh/mesh.h)
	return !(cau_dot(side[0], cau_cross(side[1], side[2])) > 0);
}

void cau_session_forget_inversion(cau_session *session)
{
	cau_inversion *inversion = &session->inversion;
	memset(inversion->ticks, 0,
	       (size_t)session->tissue.tetrahedron_count * sizeof *inversion->ticks);
	memset(inversion->long_count, 0, sizeof inversion->long_count);
	inversion->followed = false;
}

void cau_session_follow_inversion(cau_session *session)
{
	cau_inversion *inversion = &session->inversion;
	const cau_tissue *tissue = &session->tissue;
	const uint8_t *alive = session->dissection.alive.element[CAU_ELEMENT_TETRAHEDRON];
	CAU_ASSERT(inversion->long_ticks > 0, "nothing stays for %d ticks", inversion->long_ticks);
	if (!inversion->count) {
		if (inversion->followed)
			cau_session_forget_inversion(session);
		return;
	}
	memset(inversion->long_count, 0, sizeof inversion->long_count);
	inversion->followed = true;
	for (int32_t i = 0; i < tissue->tetrahedron_count; i++) {
		uint16_t *ticks = &inversion->ticks[i];
		const int32_t *vertex = tissue->primitives.tetrahedron + 4 * (size_t)i;
		if (!alive[i] || !cau_session_is_inverted(session->vertices.position, vertex))
			*ticks = 0;
		else if (*ticks < inversion->long_ticks)
			++*ticks;
		inversion->long_count[tissue->tetrahedron_layer[i]] += *ticks == inversion->long_ticks;
	}
}
