// SPDX-License-Identifier: GPL-3.0-or-later
// The tool's temperature (section 6.2, eq. 18-19): nested grids of N x N x N nodes, along the
// world's axes, that follow the hot part.
#pragma once

#include <stdbool.h>

#include "base/pages.h"
#include "base/vector.h"
#include "cautery/status.h"
#include "heat/heat_field.h"
#include "heat/heat_surface.h"
#include "tool/tool_shape.h"

enum {
	CAU_HEAT_SUBSTEPS_MAX = 64, // of one tick
	CAU_HEAT_FIELDS = 4,        // each twice as wide as the one within it
};

typedef struct cau_heat_grid {
	int32_t nodes;      // N along each axis, of every field
	double diffusivity; // alpha, m^2/s
	double ambient_c;
	float
		coldest_c; // over the nodes after the last advance; the innermost field's while one is held
	float warmest_c;  // over the same nodes; equal to coldest_c where every node is at ambient
	bool outer_rests; // only the innermost field has nodes off ambient
	cau_pages pages;  // of all that follows
	cau_heat_field field[CAU_HEAT_FIELDS]; // the innermost first: its step is dl
	cau_heat_surface surface;              // of the hot part, in the innermost field
	float *fall;                           // (N x N): for the outermost field's boundary
} cau_heat_grid;

// Whether a tool's grid is possible. Refused (CAU_BAD_VALUE, path "grid_step_m", "grid_cells" or
// "diffusivity_m2_s") are a step above the thinnest hot radius, a pair (dl, alpha) that needs more
// than 64 substeps of `tick_s` (dt_heat <= dl^2 / (6 alpha)), and fewer than 3 nodes along an axis.
cau_status cau_heat_grid_check(const cau_tool_def *tool, double tick_s, cau_error *error);

// Makes the grid of a tool, all of it at ambient. Refuses what cau_heat_grid_check refuses, and
// CAU_NO_MEMORY. The caller finishes a grid that was created; a refused one needs no finish.
cau_status cau_heat_grid_create(cau_heat_grid *grid, const cau_tool_def *tool, double ambient_c,
                                double tick_s, const cau_pose *pose, cau_error *error);
void cau_heat_grid_finish(cau_heat_grid *grid);

// Advances by `duration_s` with the tool at `pose`: follows the centre of the hot part (for a
// sphere, the tip) in whole cells, holds the hot part at the tool's temperature if `energized`,
// substeps as stability asks. Allocates nothing. The cost is O(N^3) while any node is off ambient,
// O(1) otherwise: a field nowhere further than 0.01 degC from ambient is set to ambient, and the
// outer ones are as soon as nothing is held and none is further than 4 degC.
void cau_heat_grid_advance(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                           double jaw, bool energized, double duration_s);

// Takes over what is not in the fields after a caller wrote them and the innermost one's origin (a
// restored snapshot): the extremes, the other origins, and the surface at the pose and the jaw of
// the last advance.
void cau_heat_grid_take_over(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                             double jaw, bool energized);

// Fills the outer fields from the innermost one, at ambient beyond it: for what knew no other.
void cau_heat_grid_fill_outer(cau_heat_grid *grid);

// degC at a point of the world: in the innermost field that has it, ambient outside all. The tool's
// temperature within the hot part that is held; outside, the field is continued to its surface.
double cau_heat_grid_at(const cau_heat_grid *grid, cau_vec3 point);

// The box beyond which all is at ambient, m.
void cau_heat_grid_box(const cau_heat_grid *grid, cau_vec3 *least, cau_vec3 *most);

// Whether every node is at ambient (within 0.01 degC: see cau_heat_grid_advance).
bool cau_heat_grid_is_ambient(const cau_heat_grid *grid);

// Warmest node; ambient when cold. degC.
double cau_heat_grid_warmest(const cau_heat_grid *grid);

// Equal parts that `duration_s` must be cut into so that none exceeds dl^2 / (6 alpha).
int64_t cau_heat_grid_substeps(double step_m, double diffusivity_m2_s, double duration_s);
