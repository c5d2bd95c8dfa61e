// SPDX-License-Identifier: GPL-3.0-or-later
// The channels of stress and temperature at the vertices.
#include "frame/frame_state.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"

// ---- stress
// Small-strain von Mises stress from the fat's Green strain. The channel is for
// display, not for design: it shows where tissue is strained, in the units of the tissue's Young's
// modulus.

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

// ---- temperature
// The temperatures of the tools' heat grids at the vertices, interpolated
// as for exposure. The method stores no heat in the tissue itself: tissue outside all grids is at
// ambient.

static const double BOX_MARGIN_M = 1e-6; // m; rounding of the blocks' boxes to single precision

void cau_frame_cool(cau_frame_state *frame, const cau_tissue *tissue, double ambient_c)
{
	frame->ambient_c = (float)ambient_c;
	frame->heated_count = 0;
	for (int32_t v = 0; v < tissue->vertex_count; v++)
		frame->temperature[v] = frame->ambient_c;
}

void cau_frame_cool_heated(cau_frame_state *frame)
{
	CAU_ASSERT(frame->heated_count >= 0, "%d vertices are heated", frame->heated_count);
	for (int32_t k = 0; k < frame->heated_count; k++)
		frame->temperature[frame->heated[k]] = frame->ambient_c;
	frame->heated_count = 0;
}

// Whether a box of vertices meets the box of a heat grid.
static bool boxes_meet(const double least[3], const double most[3], const cau_box *box)
{
	const double margin = BOX_MARGIN_M;
	for (int axis = 0; axis < 3; axis++) {
		CAU_ASSERT(least[axis] <= most[axis], "a box from %g to %g", least[axis], most[axis]);
		if ((double)box->most[axis] < least[axis] - margin ||
		    (double)box->least[axis] > most[axis] + margin)
			return false;
	}
	return true;
}

void cau_frame_heat_vertex(cau_frame_state *frame, int32_t vertex, float temperature)
{
	CAU_ASSERT(vertex >= 0, "vertex %d", vertex);
	float *held = &frame->temperature[vertex];
	if (fabsf(temperature - frame->ambient_c) <= fabsf(*held - frame->ambient_c))
		return;
	if (*held == frame->ambient_c)
		frame->heated[frame->heated_count++] = vertex;
	*held = temperature;
}

void cau_frame_heat(cau_frame_state *frame, const cau_near *near, const cau_heat_grid *grid,
                    const double *position)
{
	if (cau_heat_grid_is_ambient(grid))
		return;
	cau_vec3 first, last_node;
	double least[3], most[3];
	cau_heat_grid_box(grid, &first, &last_node);
	cau_vec3_to(first, least);
	cau_vec3_to(last_node, most);
	for (int32_t b = 0; b < near->block_count; b++) {
		if (!boxes_meet(least, most, &near->vertex_box[b]))
			continue;
		int32_t last = (b + 1) * CAU_NEAR_BLOCK;
		for (int32_t i = b * CAU_NEAR_BLOCK; i < last && i < near->vertex_count; i++) {
			int32_t v = near->vertex[i];
			CAU_ASSERT_INDEX(v, near->vertex_count);
			cau_vec3 at = cau_vec3_of(position + 3 * (size_t)v);
			cau_frame_heat_vertex(frame, v, (float)cau_heat_grid_at(grid, at));
		}
	}
}
