// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>
#include <stdint.h>

// Cuts a polygon into `count` - 2 triangles and writes the indices of their corners to `triangle`.
// A polygon that is convex as seen from its first corner becomes a fan around that corner. So does
// every polygon of more than 4096 corners. Any other polygon is cut by removing ears. `position`
// has the positions of all vertices. Returns false if memory ran out.
bool cau_polygon_cut(const double *position, const int32_t *vertex, int32_t count,
                     int32_t (*triangle)[3]);
