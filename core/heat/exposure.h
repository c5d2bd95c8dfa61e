// SPDX-License-Identifier: GPL-3.0-or-later
// Exposure of edges to heat (eq. 20 as an integral) and ignition.
#pragma once

#include "heat/heat_grid.h"

enum { CAU_LIVING_C = 45 }; // below this mean temperature tissue does not char

// Exposure (degC) that an edge a-b gains in duration_s: xi (u_a + u_b)/2 dt while the edge meets
// the hot part's shape at `pose` or lies inside it and that mean exceeds CAU_LIVING_C, else 0.
double cau_exposure_gain(const cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                         double jaw, cau_vec3 a, cau_vec3 b, double absorption_per_s,
                         double duration_s);

// Number of equal parts of a tick's motion (at least 1, at most 32) such that no point of the hot
// part moves by more than half its thinnest radius in one part: the swept shape is the union of the
// parts.
int cau_exposure_parts(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to);

// The same, and so many more, up to four, that no point of the hot part moves by more than half a
// cell of the tool's grid in one: the field is that of a tool which moves, not of one that leaps.
int cau_heating_parts(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to);

// Ignition temperature of edge `edge` in layer `layer`: mean + spread * g, g standard normal (cut
// off at 3), drawn from (seed, layer, edge) alone; never below a tenth of the mean.
double cau_ignition_of(double mean_c, double spread_c, uint64_t seed, int32_t layer, int32_t edge);

// The same where fibres part in bundles: g is a smooth normal field over rest space, drawn from
// (seed, layer, place) alone. It changes over bundle_m (> 0) across `fibre` (unit) and over eight
// times that along it. `place`: middle of the edge at rest, m.
double cau_ignition_in_bundles(double mean_c, double spread_c, uint64_t seed, int32_t layer,
                               cau_vec3 place, cau_vec3 fibre, double bundle_m);
