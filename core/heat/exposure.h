// SPDX-License-Identifier: GPL-3.0-or-later
// Exposure of edges to heat (eq. 20 as an integral), and ignition temperatures.
#pragma once

#include "heat/heat_grid.h"

enum { CAU_LIVING_C = 45 }; // mean temperature of an edge, degC, up to which tissue does not char

// Returns the exposure (degC) that an edge a-b gains in duration_s: xi (u_a + u_b)/2 dt. It is 0
// unless the edge meets the hot part's shape at `pose`, or is inside, and the mean temperature
// exceeds CAU_LIVING_C.
double cau_exposure_gain(const cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                         double jaw, cau_vec3 a, cau_vec3 b, double absorption_per_s,
                         double duration_s);

// Returns the number of equal parts of a tick's motion, 1 to 32. In each part no point of the hot
// part moves by more than half of its thinnest radius. The swept shape is then the union of the
// parts.
int cau_exposure_parts(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to);

// Returns the number of equal parts of a tick's motion for heating. It is at least
// cau_exposure_parts, and otherwise as many as the grid needs, up to four. The grid needs so many
// parts that no point of the hot part moves by more than half a cell of the tool's grid in one
// part. The field is then that of a tool that moves, not of a tool that jumps.
int cau_heating_parts(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to);

// Returns the ignition temperature of edge `edge` in layer `layer`: mean + spread * g. g is
// standard normal, limited to -3 to 3, and depends only on (seed, layer, edge). The result is never
// below a tenth of the mean.
double cau_ignition_of(double mean_c, double spread_c, uint64_t seed, int32_t layer, int32_t edge);

// Returns the ignition temperature of an edge in tissue whose fibres part in bundles: mean + spread
// * g. g is a smooth normal field over rest space, limited to -3 to 3, and depends only on (seed,
// layer, place). It changes over bundle_m (> 0) across `fibre` (unit), and over eight times that
// length along `fibre`. `place` is the middle of the edge at rest, m. The result is never below a
// tenth of the mean.
double cau_ignition_in_bundles(double mean_c, double spread_c, uint64_t seed, int32_t layer,
                               cau_vec3 place, cau_vec3 fibre, double bundle_m);
