// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>
#include <stdint.h>

// Fills map (vertex_count). Each vertex is mapped to the lowest kept vertex that is nearer than
// `distance` (above zero), or to itself. `position` (vertex_count x 3) is at most 1e15 distances
// above `origin`. O(vertex_count). Returns false if memory ran out.
bool cau_vertex_merge(const double *position, int32_t vertex_count, const double origin[3],
                      double distance, int32_t *map);

// Fills `map` as cau_vertex_merge does, for a distance of 1e-5 of the diagonal of the bounding box.
// Two vertices of a file that are nearer count as one. A file of single precision, or with six
// digits, has its vertices within 1e-6.
bool cau_vertex_merge_near(const double *position, int32_t vertex_count, int32_t *map);
