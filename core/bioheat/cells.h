// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of tissue: equal cubes in rest space, in which heat, water, damage and current are
// computed. They lie in rest space, so heat and damage move with the tissue.
#pragma once

#include <stdint.h>

#include "base/memory.h"
#include "cautery/status.h"

enum {
	CAU_CELL_SIDES = 6, // -x, +x, -y, +y, -z, +z
	CAU_CELL_MATERIALS = 256,
};

// A pull-back is between its inverse and this. Jaws compress to a fifth, which is 25; beyond this
// an element counts as no flatter. A power of two: as a float it and its inverse are exact, so that
// snapshots can ask for them.
#define CAU_PULL_MOST 32.0

typedef struct cau_cells {
	double side_m;
	int32_t count, capacity;
	int32_t *place;     // (capacity x 3): the cell's middle is at (place + 1/2) side_m
	int32_t *neighbour; // (capacity x 6): the cell on each side; -1: none that conducts
	uint8_t *material;  // (capacity)
	float *fill;        // (capacity): share of the cube that is tissue, above 0, at most 1
	uint8_t *severed;   // (capacity): see cau_cells_sever
	float *pull;        // (capacity x 3): diagonal of J F^-1 F^-T, the pull-back of a conductivity
	int32_t bucket_count; // a power of two
	int32_t *bucket;      // (bucket_count): cells by place, from 1 on; 0: empty. So an empty set
	                      // touches none of its memory.
} cau_cells;

// Places in arrays by cell and side, and by cell and axis.
static inline int64_t cau_cell_side(int32_t cell, int side)
{
	return (int64_t)cell * CAU_CELL_SIDES + side;
}

static inline int64_t cau_cell_axis(int32_t cell, int axis)
{
	return (int64_t)cell * 3 + axis;
}

// An empty set with room for `capacity` cells of `side_m` (both above 0). CAU_NO_MEMORY.
cau_status cau_cells_create(cau_cells *cells, double side_m, int32_t capacity, cau_arena *arena,
                            cau_error *error);

// The cell at a place; -1 if there is none.
int32_t cau_cells_find(const cau_cells *cells, const int32_t place[3]);

// Adds a cell at a place that has none, undeformed, and joins it with its neighbours. Returns its
// number, which stays; -1 if there is no room.
int32_t cau_cells_add(cau_cells *cells, const int32_t place[3], uint8_t material, float fill);

// Makes `to` equal to `from`, which has the same capacity.
void cau_cells_copy(cau_cells *to, const cau_cells *from);

// Separates a cell from its neighbours, also from those that are added later: nothing is conducted
// between them from then on.
void cau_cells_sever(cau_cells *cells, int32_t cell);

// Of conduction between a cell and its neighbour on `side`, per unit of conductivity: area over
// length, m. The area is that of the emptier of both.
double cau_cells_face(const cau_cells *cells, int32_t cell, int side);

// m^3 of tissue in the cell.
double cau_cells_volume(const cau_cells *cells, int32_t cell);
