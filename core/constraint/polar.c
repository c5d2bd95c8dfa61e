// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>

#include "base/vector.h"

#define CAU_SINGLE 0
#include "cautery/assert.h"
#include "constraint/polar.h"

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static double normalise(double a[3])
{
	double length = sqrt(dot(a, a));
	for (int i = 0; i < 3 && length > 0; i++)
		a[i] /= length;
	return length;
}

// Computes the unit quaternion of a rotation matrix r[row][column] [Shepperd 1978].
static void quaternion_of(double r[3][3], double q[4])
{
	double trace = r[0][0] + r[1][1] + r[2][2];
	if (trace > 0) {
		double s = sqrt(trace + 1) * 2;
		q[0] = s / 4;
		q[1] = (r[2][1] - r[1][2]) / s;
		q[2] = (r[0][2] - r[2][0]) / s;
		q[3] = (r[1][0] - r[0][1]) / s;
		return;
	}
	int i = r[1][1] > r[0][0] ? 1 : 0;
	i = r[2][2] > r[i][i] ? 2 : i;
	int j = (i + 1) % 3, k = (i + 2) % 3;
	CAU_ASSERT(r[i][i] >= r[j][j] && r[i][i] >= r[k][k], "axis %d is not the largest", i);
	double s = sqrt(r[i][i] - r[j][j] - r[k][k] + 1) * 2;
	q[0] = (r[k][j] - r[j][k]) / s;
	q[1 + i] = s / 4;
	q[1 + j] = (r[j][i] + r[i][j]) / s;
	q[1 + k] = (r[k][i] + r[i][k]) / s;
}

void cau_polar_robust(const double a[9], double q[4])
{
	// Computes the eigenvectors of A^T A, ordered by eigenvalue, the largest first.
	const double *c0 = a, *c1 = a + 3, *c2 = a + 6;
	const double metric[6] = {dot(c0, c0), dot(c1, c1), dot(c2, c2),
	                          dot(c0, c1), dot(c0, c2), dot(c1, c2)};
	double value[3], v[3][3];
	cau_symmetric_eigen3(metric, value, v);
	int order[3] = {0, 1, 2};
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2 - i; j++)
			if (value[order[j]] < value[order[j + 1]]) {
				int swap = order[j];
				order[j] = order[j + 1], order[j + 1] = swap;
			}
	// Computes the left singular vectors u_1 and u_2 from A v. u_3 = u_1 x u_2 reverses the
	// smallest direction if det A < 0, because v_3 = v_1 x v_2 is right-handed too.
	double right[3][3], left[3][3], length[2];
	for (int i = 0; i < 2; i++) {
		for (int k = 0; k < 3; k++)
			right[i][k] = v[k][order[i]];
		for (int k = 0; k < 3; k++)
			left[i][k] = a[k] * right[i][0] + a[3 + k] * right[i][1] + a[6 + k] * right[i][2];
		length[i] = normalise(left[i]);
	}
	// The limits below which a singular direction is not known. length[1] is the square root of an
	// eigenvalue, so its error is about 1e-8 of length[0]. A hundred times that error still gives a
	// direction. length[0] is a stretch, which is 1 at rest.
	if (!(length[1] > 1e-6 * length[0]) || !(length[0] > 1e-6))
		return; // two singular values vanish, or all three: the last rotation stays
	double along = dot(left[0], left[1]);
	for (int k = 0; k < 3; k++)
		left[1][k] -= along * left[0][k];
	normalise(left[1]);
	cross(right[0], right[1], right[2]);
	cross(left[0], left[1], left[2]);
	double rotation[3][3];
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 3; k++)
			rotation[k][c] =
				left[0][k] * right[0][c] + left[1][k] * right[1][c] + left[2][k] * right[2][c];
	quaternion_of(rotation, q);
}
