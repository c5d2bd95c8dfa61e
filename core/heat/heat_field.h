// SPDX-License-Identifier: GPL-3.0-or-later
// A temperature field of a tool, its step in time, and the hot part's surface in it. Private to
// core/heat.
//
// The field is one of the nested fields of a tool: N x N x N nodes, x fastest. Each field is twice
// as wide as the next inner field, and its cells are twice as long. Every second node of a field is
// a node of the next wider field.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/vector.h"
#include "tool/tool_shape.h"

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

// ---- one explicit step of the heat equation on a cubic grid (eq. 18-19, FTCS)
// Computes next = u + rate (sum of the six neighbours - 6 u) at every inner node of the (nodes x
// nodes x nodes) grid, x fastest. The outer nodes of `next` are not changed. `rate` is alpha dt /
// dl^2, at most 1/6 for stability.
void cau_diffuse(const float *temperature, float rate, float *next, int32_t nodes);

// Computes the step near a surface that is held at held_c: next = u + rate (sum - 6 u + pull
// (held_c - u)). Each node has its own rate and pull (heat_surface.c). A node with rate 0 keeps its
// value exactly.
void cau_diffuse_around(const float *temperature, const float *rate, const float *pull,
                        float held_c, float *next, int32_t nodes);

// Finds the least and the greatest of `count` values. `count` is at least 1.
void cau_extremes(const float *values, int64_t count, float *least, float *greatest);

// ---- the hot part's surface in the innermost field (heat_surface.c)
typedef struct cau_heat_surface {
	bool held;                // there is a surface: the tool was energized in the last advance
	float held_c;             // degC: temperature at and inside the surface
	int32_t least[3], end[3]; // range of the nodes that are less than a cell from the surface
	// Cells, (N x N x N): signed distance of each node, negative inside. It is valid while `held`
	// is true. It is exact within a cell of the surface; elsewhere only the sign is valid.
	float *distance;
	float *rate; // scratch, (N x N x N): rate of each node for cau_diffuse_around
	float *pull; // scratch, (N x N x N): pull of each node for cau_diffuse_around
} cau_heat_surface;

// Finds the hot part's surface at `pose`, and marks it as held.
void cau_heat_surface_find(cau_heat_surface *surface, const cau_heat_field *field, int32_t nodes,
                           const cau_tool_def *tool, const cau_pose *pose, double jaw);

// Sets the nodes inside to the held temperature, and computes `rate` and `pull`. The argument
// `rate` is alpha dt / dl^2.
void cau_heat_surface_hold(cau_heat_surface *surface, cau_heat_field *field, int32_t nodes,
                           double rate);

// Returns the field at the point of a cell, degC. Inside the surface this is the tool's
// temperature. Near the surface, the outer nodes are extrapolated by distance. Elsewhere the nodes
// are interpolated trilinearly.
double cau_heat_surface_at(const cau_heat_surface *surface, const cau_heat_field *field,
                           int32_t nodes, const cau_heat_cell *cell);
