// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>
#include <stdint.h>

// Fills map (vertex_count): the lowest vertex nearer than `distance` (above zero) among those that
// stay, or the vertex itself. `position` (vertex_count x 3) lies at most 1e15 distances above
// `origin`. O(vertex_count). False: memory ran out.
bool cau_vertex_merge(const double *position, int32_t vertex_count, const double origin[3],
                      double distance, int32_t *map);
