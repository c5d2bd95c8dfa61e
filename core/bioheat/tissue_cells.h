// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of a tissue: which cells an element fills, where they are in the world, and whether an
// element's cells still connect its vertices. Triangles, tetrahedra and links have cells.
#pragma once

#include "base/vector.h"
#include "bioheat/current.h"
#include "tissue/tissue.h"

typedef struct cau_tissue_cells {
	const cau_tissue *tissue;
	cau_bioheat bioheat;
	cau_current current;
	cau_bioheat_material material[CAU_MAX_LAYERS];
	// (triangle_count + link_count): half of a sheet's thickness, or a link's radius, when the
	// cells were created.
	double *half_m;
	int32_t filled_count;
	int32_t *filled;    // elements in the order of filling
	uint8_t *is_filled; // (elements)
	int32_t *owner;     // (capacity): the element with which a cell moves
	// (capacity x 3): the cell's middle in coordinates of its owner (cau_tissue_cells_at).
	float *local;
	// (elements): how much farther from the element's middle its cells are than its corners, at
	// rest.
	float *beyond_m;
	int32_t *member; // scratch: (capacity)
	int32_t *stamp;  // scratch: (capacity)
	int32_t last_stamp;
} cau_tissue_cells;

// Makes an empty set with capacity for `capacity` cells of side_m. Its parts contain pointers to
// each other, so *cells must not be copied or moved. Error: CAU_NO_MEMORY.
cau_status cau_tissue_cells_create(cau_tissue_cells *cells, const cau_tissue *tissue, double side_m,
                                   int32_t capacity, double ambient_c, cau_arena *arena,
                                   cau_error *error);

// Makes an empty set for the tissue of `other`, with the sizes of `other`. Sheets have the
// thickness that they had when `other` was created, because materials may have changed since.
cau_status cau_tissue_cells_create_like(cau_tissue_cells *cells, const cau_tissue_cells *other,
                                        cau_arena *arena, cau_error *error);

// Returns the number of elements that may have cells: triangles, then tetrahedra, then links.
int32_t cau_tissue_cells_elements(const cau_tissue_cells *cells);

// Returns an element's index among all elements, from its kind (CAU_PRIMITIVE_*) and its index in
// that kind.
int32_t cau_tissue_cells_element(const cau_tissue *tissue, int primitive, int32_t index);

// Returns the kind of an element; *index is its index in that kind.
int cau_tissue_cells_primitive(const cau_tissue *tissue, int32_t element, int32_t *index);

// Makes the cells of an element, at ambient temperature. Existing cells that other elements share
// get more tissue. Does nothing if the element is filled already. Returns false, and makes no cell,
// if the capacity is too small for all its cells.
bool cau_tissue_cells_fill(cau_tissue_cells *cells, int32_t element);

// Returns the cell's middle in the world, for tissue at `position` (m, vertex_count x 3).
cau_vec3 cau_tissue_cells_at(const cau_tissue_cells *cells, int32_t cell, const double *position);

// Computes a sphere in the world around the middles of all cells that the element owns, m.
void cau_tissue_cells_bound(const cau_tissue_cells *cells, int32_t element, const double *position,
                            cau_vec3 *middle, double *radius_m);

// Sets the cell's pull-back (cells.h) from the deformation of its owner.
void cau_tissue_cells_stretch(cau_tissue_cells *cells, int32_t cell, const double *position);

// True if the element's cells no longer connect its vertices.
bool cau_tissue_cells_separated(cau_tissue_cells *cells, int32_t element);

// True if the element may have cells at positions from `least` to `most`.
bool cau_tissue_cells_meets(const cau_tissue_cells *cells, int32_t element, const int32_t least[3],
                            const int32_t most[3]);

// Returns the cell half way between two vertices at rest, or -1 if there is none. The cell may be
// severed.
int32_t cau_tissue_cells_between(const cau_tissue_cells *cells, int32_t a, int32_t b);

// Call this after elements were removed. Their cells then move with the element of the nearest
// connected cell. Cells without a connection to a remaining element are severed, and their heat is
// removed. `alive`: by kind and index; 0: the element was removed.
void cau_tissue_cells_reassign(cau_tissue_cells *cells, uint8_t *const alive[CAU_PRIMITIVE_KINDS]);

// Makes a cell move with the element.
void cau_tissue_cells_give(cau_tissue_cells *cells, int32_t cell, int32_t element);

// Makes `to` equal to `from`, which has the same tissue and capacity.
void cau_tissue_cells_copy(cau_tissue_cells *to, const cau_tissue_cells *from);

// Continues `hash` with the state of all cells.
uint64_t cau_tissue_cells_hash(const cau_tissue_cells *cells, uint64_t hash);

// Returns the temperature at a vertex, degC: the mean of the cells around the vertex's rest
// position, or ambient if there are no such cells.
double cau_tissue_cells_temperature(const cau_tissue_cells *cells, int32_t vertex);
