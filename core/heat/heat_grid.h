// SPDX-License-Identifier: GPL-3.0-or-later
// The temperature around a tool (section 6.2, eq. 18-19): nested grids of N x N x N nodes along the
// world's axes, which follow the hot part.
#pragma once

#include <stdbool.h>

#include "base/memory.h"
#include "base/vector.h"
#include "cautery/status.h"
#include "heat/heat_field.h"
#include "tool/tool_shape.h"

enum {
	CAU_HEAT_SUBSTEPS_MAX = 64, // most substeps of one tick
	CAU_HEAT_FIELDS = 4, // number of nested fields; each is twice as wide as the next inner one
};

typedef struct cau_heat_grid {
	int32_t nodes;      // N along each axis, of every field
	double diffusivity; // alpha, m^2/s
	double ambient_c;
	// Coldest node after the last advance; of the innermost field while a surface is held.
	float coldest_c;
	float warmest_c;  // warmest of the same nodes; equal to coldest_c if every node is at ambient
	bool outer_rests; // only the innermost field has nodes off ambient
	cau_pages pages;  // memory of all following members
	cau_heat_field field[CAU_HEAT_FIELDS]; // the innermost first; its step is dl
	cau_heat_surface surface;              // surface of the hot part, in the innermost field
	float *fall;                           // (N x N): for the boundary of the outermost field
} cau_heat_grid;

// Checks whether a tool's grid is possible. Errors are CAU_BAD_VALUE at "grid_step_m", "grid_cells"
// or "diffusivity_m2_s". Refused are: a step above the thinnest hot radius; a pair (dl, alpha) that
// needs more than 64 substeps of `tick_s` (dt_heat <= dl^2 / (6 alpha)); and fewer than 3 nodes
// along an axis.
cau_status cau_heat_grid_check(const cau_tool_def *tool, double tick_s, cau_error *error);

// Makes the grid of a tool, with all nodes at ambient. Errors: those of cau_heat_grid_check, and
// CAU_NO_MEMORY. After success the caller calls cau_heat_grid_finish; after an error no call is
// needed.
cau_status cau_heat_grid_create(cau_heat_grid *grid, const cau_tool_def *tool, double ambient_c,
                                double tick_s, const cau_pose *pose, cau_error *error);
void cau_heat_grid_finish(cau_heat_grid *grid);

// Advances by `duration_s` with the tool at `pose`. The grid follows the centre of the hot part
// (for a sphere, the tip) in whole cells. If `energized`, the hot part is held at the tool's
// temperature. Uses as many substeps as stability needs. Allocates nothing. The cost is O(N^3)
// while any node is off ambient, else O(1). A field within 0.01 degC of ambient is set to ambient.
// The outer fields are set to ambient as soon as no surface is held and all nodes are within 4 degC
// of ambient.
void cau_heat_grid_advance(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                           double jaw, bool energized, double duration_s);

// Completes the grid after a caller wrote the fields and the origin of the innermost field (a
// restored snapshot). Computes the extremes, the other origins, and the surface at the pose and jaw
// of the last advance.
void cau_heat_grid_take_over(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                             double jaw, bool energized);

// Fills the outer fields from the innermost field, with ambient beyond it. For snapshots that
// contain only the innermost field.
void cau_heat_grid_fill_outer(cau_heat_grid *grid);

// Returns the temperature at a point of the world, degC. Uses the innermost field that contains the
// point; outside all fields it is ambient. Inside a held hot part it is the tool's temperature.
// Outside the hot part the field is extrapolated to its surface.
double cau_heat_grid_at(const cau_heat_grid *grid, cau_vec3 point);

// Computes the box outside which the temperature is ambient, m.
void cau_heat_grid_box(const cau_heat_grid *grid, cau_vec3 *least, cau_vec3 *most);

// True if every node is at ambient (within 0.01 degC, see cau_heat_grid_advance).
bool cau_heat_grid_is_ambient(const cau_heat_grid *grid);

// Returns the temperature of the warmest node, degC. If all nodes are at ambient, returns ambient.
double cau_heat_grid_warmest(const cau_heat_grid *grid);

// Returns the least number of equal parts of `duration_s` that are no longer than dl^2 / (6 alpha).
int64_t cau_heat_grid_substeps(double step_m, double diffusivity_m2_s, double duration_s);
