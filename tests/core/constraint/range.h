// SPDX-License-Identifier: GPL-3.0-or-later
// A second computation of the nearest member of a strain range, for tests of strain_limit.h. This
// one uses the angle between two columns of F; strain_limit.h uses their dot products.
#pragma once

#include "core/rig/rig.h"

// Largest error of a residual. RANGE_ROUNDING of strain_limit.h, in double, moves limits by 1e-10.
// The effect is up to ten times as large for the columns drawn here.
static const double RANGE_TOLERANCE = 1e-8;

typedef struct range_limits {
	int columns;
	const double *least, *most; // engineering strains
	double shear;               // largest cosine
} range_limits;

static inline double range_dot(double f[3][3], int a, int b)
{
	return f[0][a] * f[0][b] + f[1][a] * f[1][b] + f[2][a] * f[2][b];
}

static inline double range_cosine(double f[3][3], int a, int b)
{
	return range_dot(f, a, b) / sqrt(range_dot(f, a, a) * range_dot(f, b, b));
}

// Returns the part of `turn` by which the column of length s turns. The column of length t turns by
// the rest. With this part, called `first`, the squared distance s^2 sin^2 first + t^2 sin^2 (turn
// - first) is least.
static inline double range_first_turn(double s, double t, double turn)
{
	return turn / 2 + atan2(sin(turn) * (t * t - s * s), cos(turn) * (s * s + t * t)) / 2;
}

// Adds F - P of a pair's shear to r.
static inline void range_add_shear(double f[3][3], int a, int b, double most, double r[3][3])
{
	double s = sqrt(range_dot(f, a, a)), t = sqrt(range_dot(f, b, b));
	double cosine = range_cosine(f, a, b), sign = cosine < 0 ? -1 : 1;
	if (fabs(cosine) <= most)
		return;
	double turn = acos(most) - acos(fabs(cosine)), first = range_first_turn(s, t, turn);
	double across = sqrt(1 - cosine * cosine), second = turn - first;
	for (double off = -0.3; off <= 0.3; off += 0.01) { // no other division has a smaller distance
		double x = s * sin(first + off), y = t * sin(second - off);
		double x0 = s * sin(first), y0 = t * sin(second);
		assert_true(x * x + y * y >= x0 * x0 + y0 * y0 - 1e-15);
	}
	for (int row = 0; row < 3; row++) {
		double u = f[row][a] / s, v = sign * f[row][b] / t; // unit columns
		double away_u = (fabs(cosine) * u - v) / across, away_v = (fabs(cosine) * v - u) / across;
		r[row][a] += f[row][a] - s * cos(first) * (cos(first) * u + sin(first) * away_u);
		r[row][b] += f[row][b] - sign * t * cos(second) * (cos(second) * v + sin(second) * away_v);
	}
}

// Computes the residual of the range at f, with columns in the limits' axes. Returns whether f is
// within all limits.
static inline int range_residual(const range_limits *limits, double f[3][3], double r[3][3])
{
	int inside = 1;
	memset(r, 0, 9 * sizeof(double));
	for (int a = 0; a < limits->columns; a++) {
		double length = sqrt(range_dot(f, a, a));
		double kept = fmin(fmax(length, 1 + limits->least[a]), 1 + limits->most[a]);
		inside &= kept == length;
		for (int row = 0; row < 3; row++)
			r[row][a] += (1 - kept / length) * f[row][a];
	}
	for (int a = 0; a < limits->columns; a++)
		for (int b = 0; b < a; b++) {
			inside &= fabs(range_cosine(f, a, b)) <= limits->shear;
			range_add_shear(f, b, a, limits->shear, r);
		}
	return inside;
}
