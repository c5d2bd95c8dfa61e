// SPDX-License-Identifier: GPL-3.0-or-later
// Vertices that are excluded from tissue contact in a tick (collide/collide.h), by reason:
// - Vertices held by jaws: between jaws there is no space for the contact thickness.
// - Vertices of inverted tetrahedra: their surface is inside out, and contact would keep it so.
// - Diverged vertices: the substeps of the first guess cannot follow so far a motion at a useful
//   cost.
// - Vertices that cross tissue: crossings are searched when vertices return to contact. The
//   vertices stay excluded until they no longer cross.
#include <string.h>

#include "session/session_internal.h"

// Largest share of inverted tetrahedra with tissue contact. Above this share contact is off for all
// tissue, so that elasticity alone can restore the shape.
static const double most_inverted_share = 0.01;

static void exempt_held(cau_session *session)
{
	uint8_t *exempt = session->collide.exempt;
	for (int32_t i = 0; i < session->tool_count; i++)
		for (int32_t k = 0; k < session->tool[i].grasp_count; k++) {
			const cau_grasp *grasp = &session->tool[i].grasp[k];
			for (int c = 0; c < 3; c++)
				if (grasp->vertex[c] >= 0) // the held vertex, or the corners of the held face
					exempt[grasp->vertex[c]] = 1;
		}
}

// Excludes the vertices of inverted tetrahedra. Returns true if more than most_inverted_share of
// all tetrahedra are inverted.
static bool exempt_inverted(cau_session *session)
{
	const cau_tissue *tissue = &session->tissue;
	const uint8_t *alive = session->dissection.alive.element[CAU_ELEMENT_TETRAHEDRON];
	int32_t count = 0;
	if (!session->inversion.count) // the last tick ended without inverted tetrahedra
		return false;
	for (int32_t i = 0; i < tissue->tetrahedron_count; i++) {
		const int32_t *vertex = tissue->primitives.tetrahedron + 4 * (size_t)i;
		if (!alive[i] || !cau_session_is_inverted(session->vertices.start, vertex))
			continue;
		for (int k = 0; k < 4; k++)
			session->collide.exempt[vertex[k]] = 1;
		count++;
	}
	return count > most_inverted_share * tissue->tetrahedron_count;
}

// Excludes the diverged vertices. Returns whether there are any.
static bool exempt_thrown(cau_session *session, const double *guess, double most_m)
{
	const cau_surface_parts *surface = &session->collide.surface.vertices;
	bool any = false;
	for (int32_t k = 0; k < surface->count; k++) {
		size_t v = (size_t)surface->item[k];
		cau_vec3 from = cau_vec3_of(session->vertices.start + 3 * v);
		if (!(cau_length(cau_sub(cau_vec3_of(guess + 3 * v), from)) > most_m))
			continue;
		session->collide.exempt[v] = 1;
		any = true;
	}
	return any;
}

static int32_t count_exempt(const cau_session *session)
{
	int32_t count = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		count += session->collide.exempt[v];
	return count;
}

bool cau_session_exempt(cau_session *session, const double *guess, double most_m, bool *told)
{
	cau_collide *collide = &session->collide;
	memset(collide->exempt, 0, (size_t)session->tissue.vertex_count);
	exempt_held(session);
	int32_t held = count_exempt(session);
	bool all = exempt_inverted(session);
	*told = exempt_thrown(session, guess, most_m) || all;
	if (all)
		cau_collide_forget_crossed(collide);
	else if (cau_collide_touches_again(collide))
		cau_collide_exempt_crossed(collide, session->vertices.start);
	session->solver.none_loose = all || count_exempt(session) > held;
	return !all;
}
