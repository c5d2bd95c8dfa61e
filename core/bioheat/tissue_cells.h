// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of a tissue: which cells an element fills, where they are in the world, and whether an
// element still holds its vertices together. Triangles, tetrahedra and links have cells.
#pragma once

#include "base/vector.h"
#include "bioheat/current.h"
#include "tissue/tissue.h"

typedef struct cau_tissue_cells {
	const cau_tissue *tissue;
	cau_bioheat bioheat;
	cau_current current;
	cau_bioheat_material material[CAU_MAX_LAYERS];
	double *half_m; // (triangle_count + link_count): half of a sheet's thickness, a link's radius,
	                // as the cells were created
	int32_t filled_count;
	int32_t *filled;    // elements in the order of filling
	uint8_t *is_filled; // (elements)
	int32_t *owner;     // (capacity): the element that a cell moves with
	float *local;       // (capacity x 3): its middle in the owner, by cau_tissue_cells_at
	float *beyond_m; // (elements): by how much the cells of an element are farther from its middle
	                 // than its corners, at rest
	int32_t *member; // scratch: (capacity)
	int32_t *stamp;  // scratch: (capacity)
	int32_t last_stamp;
} cau_tissue_cells;

// Room for `capacity` cells of side_m; none are there yet. Its parts point to one another, so it
// stays where it was made: copies do not work. CAU_NO_MEMORY.
cau_status cau_tissue_cells_create(cau_tissue_cells *cells, const cau_tissue *tissue, double side_m,
                                   int32_t capacity, double ambient_c, cau_arena *arena,
                                   cau_error *error);

// The same for the tissue of `other`, with its sizes and the thickness that its sheets had when it
// was created: materials may have changed since.
cau_status cau_tissue_cells_create_like(cau_tissue_cells *cells, const cau_tissue_cells *other,
                                        cau_arena *arena, cau_error *error);

// Elements that may have cells: triangles, after them tetrahedra, and after them links.
int32_t cau_tissue_cells_elements(const cau_tissue_cells *cells);

// The element's number among these, from its kind (CAU_PRIMITIVE_*) and its number in that.
int32_t cau_tissue_cells_element(const cau_tissue *tissue, int primitive, int32_t index);

// Returns its kind, and its number in that.
int cau_tissue_cells_primitive(const cau_tissue *tissue, int32_t element, int32_t *index);

// Makes the cells of an element, at ambient temperature. Cells that it shares with elements that
// were filled before are filled further. Nothing happens if it is filled already. Returns false if
// there is no room for all its cells: then none is made.
bool cau_tissue_cells_fill(cau_tissue_cells *cells, int32_t element);

// The cell's middle in the world, where the tissue is at `position` (m, vertex_count x 3).
cau_vec3 cau_tissue_cells_at(const cau_tissue_cells *cells, int32_t cell, const double *position);

// A sphere in the world around the middles of all cells that the element owns, m.
void cau_tissue_cells_bound(const cau_tissue_cells *cells, int32_t element, const double *position,
                            cau_vec3 *middle, double *radius_m);

// Sets the cell's pull-back (cells.h) from the deformation of its owner.
void cau_tissue_cells_stretch(cau_tissue_cells *cells, int32_t cell, const double *position);

// Whether the element's cells no longer join its vertices.
bool cau_tissue_cells_separated(cau_tissue_cells *cells, int32_t element);

// Whether the element may have cells with places from `least` to `most`.
bool cau_tissue_cells_meets(const cau_tissue_cells *cells, int32_t element, const int32_t least[3],
                            const int32_t most[3]);

// The cell half way between two vertices at rest, also one that was taken out; -1: none.
int32_t cau_tissue_cells_between(const cau_tissue_cells *cells, int32_t a, int32_t b);

// After elements were removed: their cells move with the element of the nearest cell that they are
// joined with. Cells that are joined with no element that is there are taken out, with their heat.
// `alive`: by kind and number in it; 0: the element was removed.
void cau_tissue_cells_reassign(cau_tissue_cells *cells, uint8_t *const alive[CAU_PRIMITIVE_KINDS]);

// Makes a cell move with the element.
void cau_tissue_cells_give(cau_tissue_cells *cells, int32_t cell, int32_t element);

// Makes `to` equal to `from`, which is of the same tissue and capacity.
void cau_tissue_cells_copy(cau_tissue_cells *to, const cau_tissue_cells *from);

// Continues `hash` over what cells hold.
uint64_t cau_tissue_cells_hash(const cau_tissue_cells *cells, uint64_t hash);

// degC at a vertex: of the cells around its rest position; ambient where there are none.
double cau_tissue_cells_temperature(const cau_tissue_cells *cells, int32_t vertex);
