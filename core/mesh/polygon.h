// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>
#include <stdint.h>

// Cuts a polygon into `count` - 2 triangles, corner numbers in `triangle`. A fan round the first
// corner where that covers a convex polygon; else by ears. `position` is that of all vertices.
// False: memory ran out.
bool cau_polygon_cut(const double *position, const int32_t *vertex, int32_t count,
                     int32_t (*triangle)[3]);
