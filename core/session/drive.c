// SPDX-License-Identifier: GPL-3.0-or-later
// Moving supports: pinned vertices that follow positions given by the caller, tick by tick.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

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
