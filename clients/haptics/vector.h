// SPDX-License-Identifier: Apache-2.0
// Vectors of three numbers. Symmetric matrices are stored as xx, yy, zz, xy, xz, yz.
#pragma once

#include <math.h>
#include <stdbool.h>

static inline double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double length3(const double a[3])
{
	return sqrt(dot3(a, a));
}

// Computes to = a + scale * b.
static inline void add_scaled3(double to[3], const double a[3], double scale, const double b[3])
{
	for (int i = 0; i < 3; i++)
		to[i] = a[i] + scale * b[i];
}

static inline bool is_finite3(const double a[3])
{
	return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]);
}

// Computes to = m a.
static inline void symmetric_times(double to[3], const double m[6], const double a[3])
{
	double x = m[0] * a[0] + m[3] * a[1] + m[4] * a[2];
	double y = m[3] * a[0] + m[1] * a[1] + m[5] * a[2];
	double z = m[4] * a[0] + m[5] * a[1] + m[2] * a[2];
	to[0] = x, to[1] = y, to[2] = z;
}
