// SPDX-License-Identifier: GPL-3.0-or-later
// Brings a scene with built-in tension to its equilibrium at creation, so that tick 0 is at rest.
// It makes steps and sets the velocity to 0 after each, until nothing moves.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

enum { MOST_STEPS = 400 };
static const double still = 1e-5; // largest move of a step, relative to the mean edge length

static bool is_identity(const double *target, int n)
{
	CAU_ASSERT(n == 2 || n == 3, "a target of %d axes", n);
	for (int i = 0; i < (n == 2 ? 3 : 6); i++)
		if (target[i] != (i < n))
			return false;
	return true;
}

bool cau_session_has_tension(const cau_session *session)
{
	const cau_tissue *tissue = &session->tissue;
	for (int32_t i = 0; i < tissue->layer_count; i++) {
		const cau_layer_def *def = &tissue->layer[i].def;
		for (int32_t m = 0; m < def->material_count && def->kind != CAU_LAYER_LINKS; m++) {
			int fat = def->kind == CAU_LAYER_FAT;
			int limit = fat ? def->fat[m].limit : def->sheet[m].limit;
			if (limit == CAU_LIMIT_TARGET &&
			    !is_identity(fat ? def->fat[m].target : def->sheet[m].target, fat ? 3 : 2))
				return true;
		}
	}
	return false;
}

static bool is_pinned(const cau_session *session)
{
	return session->solver.system.row_count < session->tissue.vertex_count;
}

static double mean_edge_m(const cau_tissue *tissue)
{
	double sum = 0;
	for (int32_t e = 0; e < tissue->edges.edge_count; e++) {
		const int32_t *v = tissue->edges.vertex + 2 * (size_t)e;
		sum += cau_length(cau_sub(cau_vec3_of(tissue->rest + 3 * (size_t)v[1]),
		                          cau_vec3_of(tissue->rest + 3 * (size_t)v[0])));
	}
	return tissue->edges.edge_count ? sum / tissue->edges.edge_count : 0;
}

static double largest_move(const cau_session *session)
{
	double most = 0;
	for (int32_t i = 0; i < 3 * session->tissue.vertex_count; i++)
		most = fmax(most, fabs(session->vertices.position[i] - session->vertices.start[i]));
	return most;
}

cau_status cau_session_relax(cau_session *session, cau_error *error)
{
	CAU_ASSERT(session->tick == 0, "relaxed at tick %llu", (unsigned long long)session->tick);
	if (!cau_session_has_tension(session))
		return CAU_OK;
	size_t n = 3 * (size_t)session->tissue.vertex_count;
	double gravity[3], accuracy = session->solver.accuracy.wanted,
					   enough = still * mean_edge_m(&session->tissue);
	memcpy(gravity, session->scene->gravity_m_s2, sizeof gravity);
	if (!is_pinned(session)) // without pins a body would fall
		memset(session->scene->gravity_m_s2, 0, sizeof gravity);
	// Relaxation needs fewer steps if each step is exact.
	session->solver.accuracy.wanted = 0;
	cau_status status = CAU_OK;
	for (int step = 0; step < MOST_STEPS && !status; step++) {
		memcpy(session->vertices.start, session->vertices.position, n * sizeof(double));
		memset(session->vertices.velocity, 0, n * sizeof(double));
		cau_session_predict(session);
		status = cau_solver_run(&session->solver, error);
		if (!status)
			cau_session_settle(session);
		if (largest_move(session) < enough)
			break;
	}
	session->solver.accuracy.wanted = accuracy;
	memset(session->vertices.velocity, 0, n * sizeof(double));
	memcpy(session->vertices.start, session->vertices.position, n * sizeof(double));
	memcpy(session->scene->gravity_m_s2, gravity, sizeof gravity);
	return status;
}
