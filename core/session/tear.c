// SPDX-License-Identifier: GPL-3.0-or-later
// Tears the elements that a tick's stretch breaks (dissect/tears.c). As with parted elements, a
// torn element leaves the local step at once and the factor in its turn. Nothing shrinks beside a
// tear.
#include "cautery/assert.h"
#include "session/session_internal.h"

// Whether the step has converged. Stretches of an unfinished iterate may be far too large.
static bool has_converged(const cau_session *session)
{
	const cau_accuracy *accuracy = &session->solver.accuracy;
	return accuracy->error <= accuracy->wanted;
}

void cau_session_tear(cau_session *session)
{
	int32_t first = session->dissection.removed_count;
	cau_dissection_tear(&session->dissection, session->vertices.position, has_converged(session),
	                    session->pool);
	cau_session_take_out(session, first);
}
