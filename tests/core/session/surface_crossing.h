// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a drawn surface crosses itself. Every edge of a drawn face is tested, by signed volumes,
// with every drawn face with which it shares no vertex. The test is independent of core's distances
// and searches.
#pragma once

#include "core/session/stage.h"

static inline double surface_volume(const double *a, const double *b, const double *c,
                                    const double *d)
{
	double u[3], v[3], w[3];
	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
		w[i] = d[i] - a[i];
	}
	return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
	       u[2] * (v[0] * w[1] - v[1] * w[0]);
}

// True if the ends are on different sides of the face's plane, and the line between them passes
// inside the face.
static inline int surface_pierces(const double *x, int32_t p, int32_t q, const int32_t *face)
{
	const double *a = x + 3 * (size_t)p, *b = x + 3 * (size_t)q, *c = x + 3 * (size_t)face[0],
				 *d = x + 3 * (size_t)face[1], *e = x + 3 * (size_t)face[2];
	for (int i = 0; i < 3; i++)
		if (fmax(a[i], b[i]) < fmin(c[i], fmin(d[i], e[i])) ||
		    fmin(a[i], b[i]) > fmax(c[i], fmax(d[i], e[i])))
			return 0;
	if (surface_volume(a, c, d, e) * surface_volume(b, c, d, e) >= 0)
		return 0;
	double first = surface_volume(a, b, c, d), second = surface_volume(a, b, d, e),
		   third = surface_volume(a, b, e, c);
	return (first > 0 && second > 0 && third > 0) || (first < 0 && second < 0 && third < 0);
}

// Returns the number of crossing pairs of an edge and a face; edges of two faces count twice. Faces
// with a corner in `left_out` (by vertex, may be NULL) are skipped.
static inline int surface_crossings_but(const cau_session *session, const uint8_t *left_out)
{
	cau_session_info info = stage_info(session);
	cau_frame frame = stage_frame(session);
	int32_t *drawn = malloc((size_t)(info.face_count + 1) * sizeof *drawn), count = 0;
	int crossings = 0;
	for (int32_t f = 0; f < info.face_count; f++) {
		const int32_t *v = info.face + 3 * (size_t)f;
		bool out = left_out && (left_out[v[0]] | left_out[v[1]] | left_out[v[2]]);
		if (!out && !(frame.face_mask[f >> 5] >> (f & 31) & 1))
			drawn[count++] = f;
	}
	for (int32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++) {
			const int32_t *own = info.face + 3 * (size_t)drawn[i];
			int32_t p = own[k], q = own[(k + 1) % 3];
			for (int32_t j = 0; j < count; j++) {
				const int32_t *face = info.face + 3 * (size_t)drawn[j];
				if (face[0] != p && face[1] != p && face[2] != p && face[0] != q && face[1] != q &&
				    face[2] != q)
					crossings += surface_pierces(frame.position, p, q, face);
			}
		}
	free(drawn);
	return crossings;
}

static inline int surface_crossings(const cau_session *session)
{
	return surface_crossings_but(session, NULL);
}
