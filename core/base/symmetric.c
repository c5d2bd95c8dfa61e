// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/vector.h"

#include <math.h>

#include "cautery/assert.h"

enum { SWEEPS = 16 };

void cau_symmetric_eigen3(const double a[6], double value[3], double v[3][3])
{
	static const int plane[3][2] = {{0, 1}, {0, 2}, {1, 2}};
	double s[3][3] = {{a[0], a[3], a[4]}, {a[3], a[1], a[5]}, {a[4], a[5], a[2]}};
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			v[i][j] = i == j;
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (int k = 0; k < 3; k++) {
			int p = plane[k][0], r = plane[k][1];
			if (s[p][r] == 0)
				continue;
			double theta = (s[r][r] - s[p][p]) / (2 * s[p][r]);
			double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
			double c = 1 / sqrt(t * t + 1), n = t * c;
			for (int i = 0; i < 3; i++) {
				double x = s[i][p], y = s[i][r];
				s[i][p] = c * x - n * y;
				s[i][r] = n * x + c * y;
			}
			for (int i = 0; i < 3; i++) {
				double x = s[p][i], y = s[r][i];
				s[p][i] = c * x - n * y;
				s[r][i] = n * x + c * y;
				x = v[i][p], y = v[i][r];
				v[i][p] = c * x - n * y;
				v[i][r] = n * x + c * y;
			}
		}
	for (int i = 0; i < 3; i++)
		value[i] = s[i][i];
}

void cau_symmetric_power3(const double a[6], double power, double floor, double out[6])
{
	CAU_ASSERT(floor >= 0 && isfinite(power), "power %g of values from %g on", power, floor);
	static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
	double value[3], v[3][3];
	cau_symmetric_eigen3(a, value, v);
	for (int k = 0; k < 3; k++)
		value[k] = pow(fmax(value[k], floor), power);
	for (int i = 0; i < 6; i++) {
		out[i] = 0;
		for (int k = 0; k < 3; k++)
			out[i] += value[k] * v[row[i]][k] * v[column[i]][k];
	}
}

void cau_symmetric_power2(const double a[3], double power, double floor, double out[3])
{
	const double wide[6] = {a[0], a[1], 1, a[2], 0, 0};
	double result[6];
	cau_symmetric_power3(wide, power, floor, result);
	out[0] = result[0];
	out[1] = result[1];
	out[2] = result[3];
}
