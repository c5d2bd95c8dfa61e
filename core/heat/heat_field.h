// SPDX-License-Identifier: GPL-3.0-or-later
// One of the nested temperature fields of a tool: N x N x N nodes, x fastest. Each field is twice
// as wide as the next inner field, and its cells are twice as long. Every second node of a field is
// a node of the next wider field. Private to core/heat.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/vector.h"

typedef struct cau_heat_field {
	double step_m; // distance between nodes
	// Node (0,0,0) in whole cells of the world: its position is origin * step_m.
	int64_t origin[3];
	float *temperature; // degC, (N x N x N)
	float *next;        // scratch of the same size
} cau_heat_field;

// The cell of a field around a point: the index of its node (0,0,0), and the weights of its eight
// nodes.
typedef struct cau_heat_cell {
	int64_t first;
	double weight[8]; // bit 0: next node along x, bit 1: y, bit 2: z
} cau_heat_cell;

// Sets all nodes of `temperature` and `next` to `value`.
void cau_heat_field_fill(cau_heat_field *field, int32_t nodes, float value);
// Exchanges `temperature` and `next`.
void cau_heat_field_swap(cau_heat_field *field);

// Computes the origin of the field around a field with the origin `finer`. Both fields then have
// the same middle, within a cell.
void cau_heat_field_origin_around(const int64_t finer[3], int32_t nodes, int64_t origin[3]);

// Moves the field to another origin. Nodes that stay keep their values to the bit. New nodes are
// interpolated from `coarser`, which must already be around the new origin. If `coarser` is NULL,
// new nodes get the value of the nearest node.
void cau_heat_field_move(cau_heat_field *field, int32_t nodes, const int64_t origin[3],
                         const cau_heat_field *coarser);

// Sets the outer nodes of `temperature` and `next` by interpolation from the next wider field.
void cau_heat_field_take_boundary(cau_heat_field *field, int32_t nodes,
                                  const cau_heat_field *coarser);

// Copies the inner nodes of `finer` to the nodes of `coarser` at the same positions.
void cau_heat_field_take_inner(cau_heat_field *coarser, int32_t nodes, const cau_heat_field *finer);

// Sets the outer nodes of the outermost field. Beyond them the temperature is assumed to fall with
// the distance from the middle, as far from a steady source. `fall` is from cau_heat_field_fall.
void cau_heat_field_open_boundary(cau_heat_field *field, int32_t nodes, float ambient_c,
                                  const float *fall);

// Fills `fall` (N x N): for each node of a face, its difference from ambient over the difference of
// the node inside.
void cau_heat_field_fall(int32_t nodes, float *fall);

// Finds the cell around a point. Returns false if the point is outside the field.
bool cau_heat_field_find(const cau_heat_field *field, int32_t nodes, cau_vec3 point,
                         cau_heat_cell *cell);

// Returns the temperature at the point of the cell, by trilinear interpolation.
double cau_heat_cell_mean(const cau_heat_cell *cell, const cau_heat_field *field, int32_t nodes);

// Returns the index of the cell's node `corner` (0 to 7).
static inline int64_t cau_heat_cell_node(const cau_heat_cell *cell, int32_t nodes, int corner)
{
	int64_t n = nodes;
	return cell->first + (corner & 1) + (corner >> 1 & 1) * n + (corner >> 2) * n * n;
}
