// SPDX-License-Identifier: GPL-3.0-or-later
// The temperature channel: the temperatures of the tools' heat grids at the vertices, interpolated
// as for exposure. The method stores no heat in the tissue itself: tissue outside all grids is at
// ambient.
#include <math.h>

#include "cautery/assert.h"
#include "frame/frame_state.h"

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
