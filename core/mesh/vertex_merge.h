// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>
#include <stdint.h>

// Fills map (vertex_count): the lowest vertex nearer than `distance` (above zero) among those that
// stay, or the vertex itself. `position` (vertex_count x 3) lies at most 1e15 distances above
// `origin`. O(vertex_count). False: memory ran out.
bool cau_vertex_merge(const double *position, int32_t vertex_count, const double origin[3],
                      double distance, int32_t *map);

// The same for the distance below which two vertices of a file are one: 1e-5 of the diagonal of the
// bounding box. A file of single precision, or with six digits, has its vertices within 1e-6.
bool cau_vertex_merge_near(const double *position, int32_t vertex_count, int32_t *map);
