// SPDX-License-Identifier: GPL-3.0-or-later
// What a tick's stretch tears (dissect/tears.c), by the way of what heat parts: out of the local
// step at once, and of the factor as its turn comes. Nothing shrinks beside a tear.
#include "cautery/assert.h"
#include "session/session_internal.h"

// Whether the step's stretches are those of its solution: an iterate on the way may be far beyond.
static bool has_converged(const cau_session *session)
{
	const cau_accuracy *accuracy = &session->solver.accuracy;
	return accuracy->error <= accuracy->wanted;
}

void cau_session_tear(cau_session *session)
{
	int32_t first = session->dissection.removed_count;
	cau_dissection_tear(&session->dissection, session->position, has_converged(session),
	                    session->pool);
	cau_session_take_out(session, first);
}
