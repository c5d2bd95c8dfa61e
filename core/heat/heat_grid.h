// SPDX-License-Identifier: GPL-3.0-or-later
// The tool's N x N x N temperature grid (section 6.2, eq. 18-19): world axes, follows the hot part.
#pragma once

#include <stdbool.h>

#include "base/pages.h"
#include "base/vector.h"
#include "cautery/status.h"
#include "tool/tool_shape.h"

enum { CAU_HEAT_SUBSTEPS_MAX = 64 }; // of one tick

typedef struct cau_heat_grid {
	int32_t nodes;      // N along each axis
	double step_m;      // dl
	double diffusivity; // alpha, m^2/s
	double ambient_c;   // outer boundary, and cells shifted in
	int64_t origin[3];  // node (0,0,0) in whole cells of the world: its position is origin * dl
	float coldest_c;    // over the nodes, after the last advance
	float warmest_c;    // likewise; equal to coldest_c where every node is at ambient
	cau_pages pages;    // of the three fields
	float *temperature; // degC, (N x N x N), x fastest
	float *next;        // scratch of the same size
	float *rate;        // scratch, (N x N x N): alpha dt / dl^2, 0 at nodes held by the tool
} cau_heat_grid;

// Refuses (CAU_BAD_VALUE, path "grid_step_m", "grid_cells" or "diffusivity_m2_s") a step above the
// thinnest hot radius, a pair (dl, alpha) that would need more than 64 substeps of `tick_s`
// (dt_heat <= dl^2 / (6 alpha)) and fewer than 3 nodes along an axis. The caller finishes what was
// created; a refused grid needs no finish.
cau_status cau_heat_grid_create(cau_heat_grid *grid, const cau_tool_def *tool, double ambient_c,
                                double tick_s, const cau_pose *pose, cau_error *error);
void cau_heat_grid_finish(cau_heat_grid *grid);

// Advances by `duration_s` with the tool at `pose`: shifts by whole cells to follow the centre of
// the hot part (for a sphere, the tip), holds inner nodes with SDF < dl/2 at the tool's temperature
// if `energized`, substeps as stability asks. Allocates nothing. The cost is O(N^3) while any node
// is off ambient, O(1) otherwise: a field nowhere further than 0.01 degC from ambient is set to
// ambient.
void cau_heat_grid_advance(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                           double jaw, bool energized, double duration_s);

// Takes over coldest_c and warmest_c from the nodes, after a caller wrote them (a restored
// snapshot).
void cau_heat_grid_survey(cau_heat_grid *grid);

// Trilinear interpolation, ambient outside the grid. degC.
double cau_heat_grid_at(const cau_heat_grid *grid, cau_vec3 point);

// Whether every node is at ambient (within 0.01 degC: see cau_heat_grid_advance).
bool cau_heat_grid_is_ambient(const cau_heat_grid *grid);

// Warmest node; ambient when cold. degC.
double cau_heat_grid_warmest(const cau_heat_grid *grid);

// Equal parts that `duration_s` must be cut into so that none exceeds dl^2 / (6 alpha).
int64_t cau_heat_grid_substeps(double step_m, double diffusivity_m2_s, double duration_s);
