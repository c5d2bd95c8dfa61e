// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue that was cut free falls for ever. Far away, single precision cannot distinguish an
// element's corners. The noise of such energies would dominate the objective of all the other
// tissue. So a vertex that is many tissue sizes away is stopped there, like a vertex without
// elements.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// Greatest distance of a vertex, in tissue sizes. There, the rounding of single precision is 1e-5
// of a size, far below an edge.
static const double farthest_sizes = 200;

double cau_session_size(const cau_session *session)
{
	const double *rest = session->tissue.rest;
	double squared = 0;
	for (size_t c = 0; c < 3; c++) {
		double least = INFINITY, most = -INFINITY;
		for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++) {
			least = fmin(least, rest[3 * v + c]);
			most = fmax(most, rest[3 * v + c]);
		}
		squared += (most - least) * (most - least);
	}
	return sqrt(squared);
}

double cau_session_farthest_from_rest(const cau_session *session)
{
	CAU_ASSERT(session->watch.size_m > 0, "tissue of %g m", session->watch.size_m);
	return farthest_sizes * session->watch.size_m;
}

static void stop(cau_session *session, size_t vertex, cau_vec3 way)
{
	CAU_ASSERT(!session->vertices.fixed[vertex], "vertex %zu is stopped twice", vertex);
	double *position = session->vertices.position + 3 * vertex;
	cau_vec3 rest = cau_vec3_of(session->tissue.rest + 3 * vertex);
	double reach_m = cau_session_farthest_from_rest(session);
	cau_vec3_to(cau_add_scaled(rest, reach_m / cau_length(way), way), position);
	memset(session->vertices.velocity + 3 * vertex, 0, 3 * sizeof(double));
	session->vertices.fixed[vertex] = 1;
	session->vertices.frozen_count++;
}

void cau_session_stop_strays(cau_session *session)
{
	CAU_ASSERT(session->vertices.frozen_count <= session->tissue.vertex_count,
	           "%d vertices frozen of %d", session->vertices.frozen_count,
	           session->tissue.vertex_count);
	bool stopped = false;
	double reach_m = cau_session_farthest_from_rest(session);
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++) {
		cau_vec3 way = cau_sub(cau_vec3_of(session->vertices.position + 3 * v),
		                       cau_vec3_of(session->tissue.rest + 3 * v));
		if (session->vertices.fixed[v] || cau_dot(way, way) <= reach_m * reach_m)
			continue;
		stop(session, v, way);
		stopped = true;
	}
	if (!stopped)
		return;
	session->watch.left_m = 0; // vertices were moved, so the edges are checked again
	session->energy.stale = true;
	cau_session_drop_frozen_grasps(session);
}
