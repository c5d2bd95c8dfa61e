// SPDX-License-Identifier: GPL-3.0-or-later
// The hot part's surface in the innermost field: where it lies between the nodes, and the boundary
// condition there. Private to this room.
#pragma once

#include "heat/heat_field.h"
#include "tool/tool_shape.h"

typedef struct cau_heat_surface {
	bool held;                // whether there is one: the tool was energized in the last advance
	float held_c;             // degC: at and within it
	int32_t least[3], end[3]; // the nodes that are less than a cell from it are from here to there
	float *distance; // cells, (N x N x N): of the nodes to it, negative within, while held; exact
	                 // within a cell of it, elsewhere only the sign counts
	float *rate;     // scratch, (N x N x N): for cau_diffuse_around
	float *pull;     // scratch, (N x N x N): for cau_diffuse_around
} cau_heat_surface;

// Where the hot part's surface is at `pose`. From then on it is held.
void cau_heat_surface_find(cau_heat_surface *surface, const cau_heat_field *field, int32_t nodes,
                           const cau_tool_def *tool, const cau_pose *pose, double jaw);

// Holds the nodes within at its temperature, and sets `rate` and `pull`; `rate` is alpha dt / dl^2.
void cau_heat_surface_hold(cau_heat_surface *surface, cau_heat_field *field, int32_t nodes,
                           double rate);

// The field in a cell, degC: within the surface the tool's temperature; outside it falls with the
// distance, as the nodes outside give it. Trilinear interpolation where the surface is not near.
double cau_heat_surface_at(const cau_heat_surface *surface, const cau_heat_field *field,
                           int32_t nodes, const cau_heat_cell *cell);
