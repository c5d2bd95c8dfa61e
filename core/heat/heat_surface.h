// SPDX-License-Identifier: GPL-3.0-or-later
// The hot part's surface in the innermost field: its position between the nodes, and the boundary
// condition there. Private to core/heat.
#pragma once

#include "heat/heat_field.h"
#include "tool/tool_shape.h"

typedef struct cau_heat_surface {
	bool held;                // there is a surface: the tool was energized in the last advance
	float held_c;             // degC: temperature at and inside the surface
	int32_t least[3], end[3]; // range of the nodes that are less than a cell from the surface
	// Cells, (N x N x N): signed distance of each node, negative inside. It is valid while `held`
	// is true. It is exact within a cell of the surface; elsewhere only the sign is valid.
	float *distance;
	float *rate; // scratch, (N x N x N): rate of each node for cau_diffuse_around
	float *pull; // scratch, (N x N x N): pull of each node for cau_diffuse_around
} cau_heat_surface;

// Finds the hot part's surface at `pose`, and marks it as held.
void cau_heat_surface_find(cau_heat_surface *surface, const cau_heat_field *field, int32_t nodes,
                           const cau_tool_def *tool, const cau_pose *pose, double jaw);

// Sets the nodes inside to the held temperature, and computes `rate` and `pull`. The argument
// `rate` is alpha dt / dl^2.
void cau_heat_surface_hold(cau_heat_surface *surface, cau_heat_field *field, int32_t nodes,
                           double rate);

// Returns the field at the point of a cell, degC. Inside the surface this is the tool's
// temperature. Near the surface, the outer nodes are extrapolated by distance. Elsewhere the nodes
// are interpolated trilinearly.
double cau_heat_surface_at(const cau_heat_surface *surface, const cau_heat_field *field,
                           int32_t nodes, const cau_heat_cell *cell);
