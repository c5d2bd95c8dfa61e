// SPDX-License-Identifier: GPL-3.0-or-later
// Plain 3x3 matrices in double, row-major: the tests' own arithmetic, independent of core's.
#pragma once

#include <math.h>
#include <string.h>

static inline void mat_identity(double a[3][3])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			a[i][j] = i == j;
}

static inline void mat_multiply(double a[3][3], double b[3][3], double out[3][3])
{
	double product[3][3] = {{0}};
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 3; k++)
				product[i][j] += a[i][k] * b[k][j];
	memcpy(out, product, sizeof product);
}

static inline void mat_transpose(double a[3][3], double out[3][3])
{
	double turned[3][3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			turned[i][j] = a[j][i];
	memcpy(out, turned, sizeof turned);
}

// Computes A^T B.
static inline void mat_transpose_multiply(double a[3][3], double b[3][3], double out[3][3])
{
	double turned[3][3];
	mat_transpose(a, turned);
	mat_multiply(turned, b, out);
}

static inline void mat_apply(double a[3][3], const double v[3], double out[3])
{
	double result[3];
	for (int i = 0; i < 3; i++)
		result[i] = a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2];
	memcpy(out, result, sizeof result);
}

static inline double mat_determinant(double a[3][3])
{
	return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
	       a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
	       a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

static inline void mat_inverse(double a[3][3], double out[3][3])
{
	double inverse[3][3], det = mat_determinant(a);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
			inverse[j][i] = (a[p][r] * a[q][s] - a[p][s] * a[q][r]) / det;
		}
	memcpy(out, inverse, sizeof inverse);
}

static inline double mat_distance(double a[3][3], double b[3][3])
{
	double most = 0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			most = fmax(most, fabs(a[i][j] - b[i][j]));
	return most;
}

// Computes the polar factor of a matrix with positive determinant, by repeated averages with the
// inverse transpose.
static inline void mat_polar(double a[3][3], double q[3][3])
{
	memcpy(q, a, 9 * sizeof(double));
	for (int step = 0; step < 60; step++) {
		double inverse[3][3];
		mat_inverse(q, inverse);
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				inverse[j][i] = (inverse[j][i] + q[i][j]) / 2;
		mat_transpose(inverse, q);
	}
}

// Computes the rotation by `angle` about an axis of any length.
static inline void mat_rotation(const double axis[3], double angle, double out[3][3])
{
	double n = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
	double u[3] = {axis[0] / n, axis[1] / n, axis[2] / n}, c = cos(angle), s = sin(angle);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = u[i] * u[j] * (1 - c) + (i == j) * c;
	out[0][1] -= s * u[2], out[1][0] += s * u[2];
	out[0][2] += s * u[1], out[2][0] -= s * u[1];
	out[1][2] -= s * u[0], out[2][1] += s * u[0];
}

// Computes the symmetric matrix with the entries 00, 11, 22, 01, 02, 12.
static inline void mat_of_symmetric(const double s[6], double out[3][3])
{
	out[0][0] = s[0], out[1][1] = s[1], out[2][2] = s[2];
	out[0][1] = out[1][0] = s[3];
	out[0][2] = out[2][0] = s[4];
	out[1][2] = out[2][1] = s[5];
}
