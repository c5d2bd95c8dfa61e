// SPDX-License-Identifier: GPL-3.0-or-later
// The stress channel: small-strain von Mises stress from the fat's Green strain. The channel is for
// display, not for design: it shows where tissue is strained, in the units of the tissue's Young's
// modulus.
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "frame/frame_state.h"

static void deformation_gradient(const cau_tissue *tissue, const double *position,
                                 int32_t tetrahedron, double f[3][3])
{
	CAU_ASSERT_INDEX(tetrahedron, tissue->tetrahedron_count);
	const int32_t *v = tissue->tetrahedron + 4 * (size_t)tetrahedron;
	const double *m = tissue->tetrahedron_dm_inverse + 9 * (size_t)tetrahedron;
	memset(f, 0, 9 * sizeof(double));
	for (int i = 0; i < 3; i++)
		for (int r = 0; r < 3; r++) {
			double d =
				position[3 * (size_t)v[i + 1] + (size_t)r] - position[3 * (size_t)v[0] + (size_t)r];
			for (int c = 0; c < 3; c++)
				f[r][c] += d * m[3 * i + c];
		}
}

static double von_mises(double f[3][3], double mu)
{
	CAU_ASSERT(mu > 0, "a shear modulus of %g Pa", mu);
	double e[3][3], trace = 0, squared = 0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			e[i][j] = (f[0][i] * f[0][j] + f[1][i] * f[1][j] + f[2][i] * f[2][j] - (i == j)) / 2;
			trace += i == j ? e[i][j] : 0;
		}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			double deviator = 2 * mu * (e[i][j] - (i == j ? trace / 3 : 0));
			squared += deviator * deviator;
		}
	return sqrt(1.5 * squared);
}

void cau_frame_stress(cau_frame_state *frame, const cau_tissue *tissue,
                      const cau_dissection *dissection, const double *position)
{
	size_t n = (size_t)tissue->vertex_count;
	memset(frame->stress, 0, n * sizeof *frame->stress);
	memset(frame->stress_weight, 0, n * sizeof *frame->stress_weight);
	for (int32_t t = 0; t < tissue->tetrahedron_count; t++) {
		if (!dissection->alive.element[CAU_ELEMENT_TETRAHEDRON][t])
			continue;
		double f[3][3], lambda, mu;
		deformation_gradient(tissue, position, t, f);
		cau_fat_lame(cau_tetrahedron_material(tissue, t), &lambda, &mu);
		double volume = tissue->tetrahedron_volume[t], stress = von_mises(f, mu);
		for (int i = 0; i < 4; i++) {
			int32_t v = tissue->tetrahedron[4 * (size_t)t + (size_t)i];
			frame->stress[v] += (float)(volume * stress);
			frame->stress_weight[v] += (float)volume;
		}
	}
	for (size_t v = 0; v < n; v++)
		if (frame->stress_weight[v] > 0)
			frame->stress[v] /= frame->stress_weight[v];
}
