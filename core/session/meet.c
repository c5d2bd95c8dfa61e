// SPDX-License-Identifier: GPL-3.0-or-later
// Contact between tissue and tissue. As a tick begins, touching pairs are found at the start
// positions, and the first guess is stopped where it would make tissue cross (collide/collide.h).
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// Largest number of substeps of the first guess. Each substep starts where the substep before it
// ended.
enum { MOST_LEGS = 16 };

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
static void go_in_legs(cau_session *session, const double *guess, double *at)
{
	cau_collide *collide = &session->collide;
	for (int leg = 0; leg < MOST_LEGS; leg++) {
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
	go_in_legs(session, guess, at);
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
	double most_m = MOST_LEGS * cau_collide_most_step(collide);
	bool cut_short, touches = cau_session_exempt(session, guess, most_m, &cut_short);
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
