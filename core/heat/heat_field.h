// SPDX-License-Identifier: GPL-3.0-or-later
// One of the nested temperature fields: N x N x N nodes, x fastest. Each is twice as wide as the
// one within it, with cells of twice the length; every other node of a field is a node of the next.
// Private to this room.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/vector.h"

typedef struct cau_heat_field {
	double step_m;      // between nodes
	int64_t origin[3];  // node (0,0,0) in whole cells of the world: its position is origin * step_m
	float *temperature; // degC, (N x N x N)
	float *next;        // scratch of the same size
} cau_heat_field;

// A cell of a field around a point: node (0,0,0) of it, and the weights of its eight nodes.
typedef struct cau_heat_cell {
	int64_t first;
	double weight[8]; // bit 0: on along x, bit 1: y, bit 2: z
} cau_heat_cell;

void cau_heat_field_fill(cau_heat_field *field, int32_t nodes, float value);
void cau_heat_field_swap(cau_heat_field *field);

// Where the field around the one at `finer` begins, so that both have the same middle within a
// cell.
void cau_heat_field_origin_around(const int64_t finer[3], int32_t nodes, int64_t origin[3]);

// Moves the field to another origin. Nodes keep their values to the bit; those that come in are
// interpolated from `coarser`, whose origin is around the new one, or take the nearest node's value
// where that is NULL.
void cau_heat_field_move(cau_heat_field *field, int32_t nodes, const int64_t origin[3],
                         const cau_heat_field *coarser);

// The outer nodes of both `temperature` and `next`, interpolated from the field around.
void cau_heat_field_take_boundary(cau_heat_field *field, int32_t nodes,
                                  const cau_heat_field *coarser);

// The nodes of `coarser` that are inner nodes of `finer` take its values.
void cau_heat_field_take_inner(cau_heat_field *coarser, int32_t nodes, const cau_heat_field *finer);

// The outer nodes of the outermost field, as if the field fell with the distance from its middle
// beyond them, as it does far from any steady source. `fall`: cau_heat_field_fall.
void cau_heat_field_open_boundary(cau_heat_field *field, int32_t nodes, float ambient_c,
                                  const float *fall);

// (N x N): by how much a node on a face is nearer to ambient than the node within it.
void cau_heat_field_fall(int32_t nodes, float *fall);

// False outside the field.
bool cau_heat_field_find(const cau_heat_field *field, int32_t nodes, cau_vec3 point,
                         cau_heat_cell *cell);

// Trilinear interpolation.
double cau_heat_cell_mean(const cau_heat_cell *cell, const cau_heat_field *field, int32_t nodes);

// Index of the cell's node `corner` (0 to 7).
static inline int64_t cau_heat_cell_node(const cau_heat_cell *cell, int32_t nodes, int corner)
{
	int64_t n = nodes;
	return cell->first + (corner & 1) + (corner >> 1 & 1) * n + (corner >> 2) * n * n;
}
