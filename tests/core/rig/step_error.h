// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the error of a step against the same step after convergence. solve/accuracy.h estimates
// this error.
#pragma once

#include <math.h>

#include "session/session_internal.h"

// Returns the error of the step over the free vertices of [first, last), in the mass norm, relative
// to their motion. A motion below 0.5 um / `accuracy` is replaced by this value, so that an error
// of half a micrometre never exceeds `accuracy`. Returns 0 if no vertex is free.
static inline double step_error_part(const cau_session *session, const double *exact, int32_t first,
                                     int32_t last, double accuracy)
{
	static const double least_error_m = 0.5e-6;
	double mass = 0, off = 0, motion = 0;
	for (int32_t v = first; v < last; v++) {
		double m = session->vertices.fixed[v] ? 0 : session->tissue.mass[v];
		mass += m;
		for (int c = 0; c < 3; c++) {
			double d = session->vertices.position[3 * v + c] - exact[3 * v + c];
			double way = exact[3 * v + c] - session->vertices.start[3 * v + c];
			off += m * d * d;
			motion += m * way * way;
		}
	}
	return mass > 0 ? sqrt(off / mass) / fmax(sqrt(motion / mass), least_error_m / accuracy) : 0;
}

// Returns the largest error of all vertices together and of each chunk of vertices. `exact` (n x 3,
// m) is the converged step.
static inline double step_error(const cau_session *session, const double *exact, double accuracy)
{
	int32_t n = session->tissue.vertex_count;
	double worst = step_error_part(session, exact, 0, n, accuracy);
	for (int32_t first = 0; first < n; first += CAU_VERTEX_CHUNK) {
		int32_t last = first + CAU_VERTEX_CHUNK < n ? first + CAU_VERTEX_CHUNK : n;
		worst = fmax(worst, step_error_part(session, exact, first, last, accuracy));
	}
	return worst;
}
