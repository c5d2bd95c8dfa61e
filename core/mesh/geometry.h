// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors, and volumes of elements, as arrays of three numbers.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static inline void cau_subtract3(const double *a, const double *b, double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = a[c] - b[c];
}

static inline void cau_cross3(const double a[3], const double b[3], double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static inline double cau_dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Computes the normal of a triangle. Its length is twice the area. `position` has the positions of
// all vertices.
static inline void cau_triangle_normal(const double *position, const int32_t *t, double normal[3])
{
	double e[2][3];
	for (int i = 0; i < 2; i++)
		cau_subtract3(position + 3 * (size_t)t[i + 1], position + 3 * (size_t)t[0], e[i]);
	cau_cross3(e[0], e[1], normal);
}

// Returns six times the signed volume of a tetrahedron.
static inline double cau_tetrahedron_volume6(const double *position, const int32_t *t)
{
	double normal[3], edge[3];
	cau_triangle_normal(position, t, normal);
	cau_subtract3(position + 3 * (size_t)t[3], position + 3 * (size_t)t[0], edge);
	return cau_dot3(normal, edge);
}

// Returns the sum of the squared lengths of all edges between an element's corners.
static inline double cau_edge_squares(const double *position, const int32_t *element, int corners)
{
	double sum = 0;
	for (int i = 0; i < corners; i++)
		for (int j = 0; j < i; j++) {
			double edge[3];
			cau_subtract3(position + 3 * (size_t)element[i], position + 3 * (size_t)element[j],
			              edge);
			sum += cau_dot3(edge, edge);
		}
	return sum;
}

// Whether a texture triangle is a line or a point. Then it gives no direction.
static inline bool cau_texture_is_flat(const double uv[6])
{
	double a = uv[2] - uv[0], b = uv[4] - uv[0], c = uv[3] - uv[1], d = uv[5] - uv[1];
	return !(fabs(a * d - b * c) > 1e-9 * ((a * a + c * c) + (b * b + d * d)));
}
