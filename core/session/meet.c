// SPDX-License-Identifier: GPL-3.0-or-later
// Contact between tissue and tissue. As a tick begins, touching pairs are found at the start
// positions, and the first guess is stopped where it would make tissue cross (collide/collide.h).
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- exclusion

// Vertices that are excluded from tissue contact in a tick (collide/collide.h), by reason:
// - Vertices held by jaws: between jaws there is no space for the contact thickness.
// - Vertices of inverted tetrahedra: their surface is inside out, and contact would keep it so.
// - Diverged vertices: the substeps of the first guess cannot follow so far a motion at a useful
//   cost.
// - Vertices that cross tissue: crossings are searched when vertices return to contact. The
//   vertices stay excluded until they no longer cross.

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

// Excludes vertices from tissue contact for this tick, among them those whose `guess` (m, n x 3) is
// more than `most_m` away. Sets *reported to true if a diverged or inverted vertex is among them.
// Returns false if tissue contact is off for the tick.
static bool exempt(cau_session *session, const double *guess, double most_m, bool *reported)
{
	cau_collide *collide = &session->collide;
	memset(collide->exempt, 0, (size_t)session->tissue.vertex_count);
	exempt_held(session);
	int32_t held = count_exempt(session);
	bool all = exempt_inverted(session);
	*reported = exempt_thrown(session, guess, most_m) || all;
	if (all)
		cau_collide_forget_crossed(collide);
	else if (cau_collide_touches_again(collide))
		cau_collide_exempt_crossed(collide, session->vertices.start);
	session->solver.none_loose = all || count_exempt(session) > held;
	return !all;
}

// ---- pairs

// Largest number of substeps of the first guess. Each substep starts where the substep before it
// ended.
enum { MOST_SUBSTEPS = 16 };

cau_status cau_session_make_collide(cau_session *session, cau_error *error)
{
	const cau_scene_def *scene = session->scene;
	cau_collide *collide = &session->collide;
	if (scene->contact_thickness_m == 0)
		return CAU_OK;
	cau_status status =
		cau_collide_create(collide, &session->tissue, scene->contact_thickness_m,
	                       scene->contact_friction, scene->step_s, &session->memory.arena, error);
	if (!status)
		status = cau_solver_make_yield(&session->solver, &session->memory.arena, error);
	if (status)
		return status;
	collide->fixed = session->vertices.fixed;
	collide->start = session->vertices.start;
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++)
		collide->alive[kind] = session->dissection.alive.element[kind];
	session->solver.collide = collide;
	return CAU_OK;
}

static void ask_for(cau_session *session, const double *from, const double *to)
{
	const cau_surface_parts *surface = &session->collide.surface.vertices;
	for (int32_t k = 0; k < surface->count; k++)
		for (size_t c = 0, i = 3 * (size_t)surface->item[k]; c < 3; c++, i++)
			session->collide.step[i] = to[i] - from[i];
}

// Adds the filtered step to the vertices of the surface. Supports keep the position that they are
// led to.
static void go(cau_session *session, double *position)
{
	const cau_collide *collide = &session->collide;
	const cau_surface_parts *surface = &collide->surface.vertices;
	for (int32_t k = 0; k < surface->count; k++) {
		size_t v = (size_t)surface->item[k];
		for (size_t i = 3 * v; i < 3 * v + 3 && !session->vertices.fixed[v]; i++)
			position[i] += collide->step[i];
	}
}

// Moves the vertices towards the guess in several substeps, if the guess would lead through tissue.
// Each substep starts where the last one ended, and is filtered.
static void go_in_substeps(cau_session *session, const double *guess, double *at)
{
	cau_collide *collide = &session->collide;
	for (int substep = 0; substep < MOST_SUBSTEPS; substep++) {
		go(session, at);
		if (!collide->filter.out_of_reach)
			return;
		ask_for(session, at, guess);
		cau_collide_filter(collide, session->pool, at, true);
	}
}

// Shortens the first guess to the motion that tissue contact permits.
static void stop_guess(cau_session *session, double *guess)
{
	cau_step_solver *solver = &session->solver;
	cau_collide *collide = solver->collide;
	double *at = solver->iterate.before; // the solver does not use this array before the solve
	memcpy(at, session->vertices.start, 3 * (size_t)session->tissue.vertex_count * sizeof(double));
	go_in_substeps(session, guess, at);
	for (int32_t k = 0; k < collide->surface.vertices.count; k++) {
		size_t v = (size_t)collide->surface.vertices.item[k];
		if (!session->vertices.fixed[v])
			memcpy(guess + 3 * v, at + 3 * v, 3 * sizeof(double));
	}
}

void cau_session_begin_collide(cau_session *session)
{
	cau_collide *collide = &session->collide;
	double *guess = session->solver.position;
	if (session->scene->contact_thickness_m == 0)
		return;
	cau_surface_list(&collide->surface, session->dissection.face_mask);
	double most_m = MOST_SUBSTEPS * cau_collide_most_step(collide);
	bool cut_short, touches = exempt(session, guess, most_m, &cut_short);
	session->solver.collide = touches ? collide : NULL;
	collide->cut_short_count = cut_short;
	if (!touches)
		return;
	ask_for(session, session->vertices.start, guess);
	cau_collide_begin(collide, session->pool, session->vertices.start);
	if (cau_collide_filter(collide, session->pool, session->vertices.start, true))
		stop_guess(session, guess);
	// from here on the filter allows short steps only
	cau_collide_see(collide, session->pool, guess);
}
