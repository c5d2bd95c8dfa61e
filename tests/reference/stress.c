// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/stress.h"

#include "cautery/scene.h"

// Computes dJ/dF, the cofactor matrix of F.
static void cofactor(double f[3][3], double out[3][3])
{
	for (int i = 0; i < 3; ++i)
		for (int j = 0; j < 3; ++j) {
			int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
			out[i][j] = f[a][c] * f[b][d] - f[a][d] * f[b][c];
		}
}

double cau_reference_determinant(double f[3][3])
{
	double c[3][3];
	cofactor(f, c);
	return f[0][0] * c[0][0] + f[0][1] * c[0][1] + f[0][2] * c[0][2];
}

// Computes P = F (2 mu E + lambda tr(E) I) with E = (F^T F - I) / 2.
static void stress_stvk(double mu, double lambda, double f[3][3], double stress[3][3])
{
	double strain[3][3], trace = 0;
	for (int i = 0; i < 3; ++i)
		for (int j = 0; j < 3; ++j) {
			double dot = f[0][i] * f[0][j] + f[1][i] * f[1][j] + f[2][i] * f[2][j];
			strain[i][j] = (dot - (i == j)) / 2;
		}
	for (int i = 0; i < 3; ++i)
		trace += strain[i][i];
	for (int i = 0; i < 3; ++i)
		for (int j = 0; j < 3; ++j) {
			stress[i][j] = lambda * trace * f[i][j];
			for (int k = 0; k < 3; ++k)
				stress[i][j] += 2 * mu * f[i][k] * strain[k][j];
		}
}

// Computes P = m (1 - 1 / (I_C + 1)) F + l (J - alpha) dJ/dF with m = 4 mu / 3, l = lambda + 5 mu /
// 6.
static void stress_neohookean(double mu, double lambda, double f[3][3], double stress[3][3])
{
	double m = 4.0 / 3.0 * mu, l = lambda + 5.0 / 6.0 * mu, alpha = 1 + m / l - m / (4 * l);
	double squares = 0, slope[3][3];
	for (int i = 0; i < 3; ++i)
		for (int j = 0; j < 3; ++j)
			squares += f[i][j] * f[i][j];
	cofactor(f, slope);
	double pressure = l * (cau_reference_determinant(f) - alpha);
	for (int i = 0; i < 3; ++i)
		for (int j = 0; j < 3; ++j)
			stress[i][j] = m * (1 - 1 / (squares + 1)) * f[i][j] + pressure * slope[i][j];
}

void cau_reference_stress(int model, double young_modulus_pa, double poisson_ratio, double f[3][3],
                          double stress[3][3])
{
	double mu = young_modulus_pa / (2 * (1 + poisson_ratio));
	double lambda = 2 * mu * poisson_ratio / (1 - 2 * poisson_ratio);
	if (model == CAU_MODEL_STVK)
		stress_stvk(mu, lambda, f, stress);
	else
		stress_neohookean(mu, lambda, f, stress);
}
