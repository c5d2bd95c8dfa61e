// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of tissue: equal cubes, in which heat, water, damage and current are computed. Cells are in
// rest space, so heat and damage move with the tissue.
#pragma once

#include <stdint.h>

#include "base/memory.h"
#include "cautery/status.h"

enum {
	CAU_CELL_SIDES = 6, // -x, +x, -y, +y, -z, +z
	CAU_CELL_MATERIALS = 256,
};

// Largest pull-back; the least is 1/32. Jaws compress tissue to a fifth, which makes a pull-back of
// 25. An element that is compressed further conducts as one at the limit. The limit is a power of
// two, so the limit and its inverse are exact as floats, and snapshots can check for them.
#define CAU_PULL_MOST 32.0

typedef struct cau_cells {
	double side_m;
	int32_t count, capacity;
	// (capacity x 3): position in the grid; the cell's middle is at (place + 1/2) side_m.
	int32_t *place;
	int32_t *neighbour; // (capacity x 6): the cell on each side; -1: no cell that conducts
	uint8_t *material;  // (capacity)
	float *fill;        // (capacity): share of the cube that is tissue, above 0, at most 1
	uint8_t *severed;   // (capacity): 1 after cau_cells_sever
	// (capacity x 3): diagonal of J F^-1 F^-T, by which a conductivity is pulled back to rest
	// space.
	float *pull;
	int32_t bucket_count; // a power of two
	// (bucket_count): hash table by position: cell index + 1; 0: empty. So the memory of an empty
	// set is never used.
	int32_t *bucket;
} cau_cells;

// Indices into arrays by cell and side, and by cell and axis.
static inline int64_t cau_cell_side(int32_t cell, int side)
{
	return (int64_t)cell * CAU_CELL_SIDES + side;
}

static inline int64_t cau_cell_axis(int32_t cell, int axis)
{
	return (int64_t)cell * 3 + axis;
}

// Makes an empty set with capacity for `capacity` cells of `side_m` (both above 0). Error:
// CAU_NO_MEMORY.
cau_status cau_cells_create(cau_cells *cells, double side_m, int32_t capacity, cau_arena *arena,
                            cau_error *error);

// Returns the cell at a position, or -1 if there is none.
int32_t cau_cells_find(const cau_cells *cells, const int32_t place[3]);

// Adds an undeformed cell at a position without a cell, and joins it with its neighbours. Returns
// the cell's index, which never changes, or -1 if the capacity is used up.
int32_t cau_cells_add(cau_cells *cells, const int32_t place[3], uint8_t material, float fill);

// Makes `to` equal to `from`, which has the same capacity.
void cau_cells_copy(cau_cells *to, const cau_cells *from);

// Separates a cell from its neighbours for good. Nothing is conducted between them, nor to
// neighbours that are added later.
void cau_cells_sever(cau_cells *cells, int32_t cell);

// Returns the conductance between a cell and its neighbour on `side`, for a conductivity of 1: area
// over length, m. The area is that of the cell with less tissue.
double cau_cells_face(const cau_cells *cells, int32_t cell, int side);

// Returns the volume of tissue in the cell, m^3.
double cau_cells_volume(const cau_cells *cells, int32_t cell);
