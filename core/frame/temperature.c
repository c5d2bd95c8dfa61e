// SPDX-License-Identifier: GPL-3.0-or-later
// The temperature channel: what the tools' heat grids say at the vertices, read as exposure reads
// them. The method keeps no heat in the tissue itself: where no grid reaches it is at ambient.
#include <math.h>

#include "cautery/assert.h"
#include "frame/frame_state.h"

static const double BOX_MARGIN_M = 1e-6; // boxes of blocks are in float

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

static bool grid_meets(const cau_heat_grid *grid, const cau_box *box)
{
	CAU_ASSERT(grid->nodes >= 2 && grid->step_m > 0, "a grid of %d nodes, %g m apart", grid->nodes,
	           grid->step_m);
	const double margin = BOX_MARGIN_M;
	for (int axis = 0; axis < 3; axis++) {
		double least = (double)grid->origin[axis] * grid->step_m;
		double most = least + (grid->nodes - 1) * grid->step_m;
		if ((double)box->most[axis] < least - margin || (double)box->least[axis] > most + margin)
			return false;
	}
	return true;
}

static void heat_vertex(cau_frame_state *frame, int32_t vertex, float temperature)
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
	if (grid->coldest_c == grid->warmest_c)
		return; // all of it at ambient
	for (int32_t b = 0; b < near->block_count; b++) {
		if (!grid_meets(grid, &near->vertex_box[b]))
			continue;
		int32_t last = (b + 1) * CAU_NEAR_BLOCK;
		for (int32_t i = b * CAU_NEAR_BLOCK; i < last && i < near->vertex_count; i++) {
			int32_t v = near->vertex[i];
			CAU_ASSERT_INDEX(v, near->vertex_count);
			cau_vec3 at = cau_vec3_of(position + 3 * (size_t)v);
			heat_vertex(frame, v, (float)cau_heat_grid_at(grid, at));
		}
	}
}
