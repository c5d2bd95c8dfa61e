// SPDX-License-Identifier: GPL-3.0-or-later
// The global system A = M/dt^2 + sum of w G^T G over the live elements. Each free vertex has one
// row, which x, y and z share. Pinned vertices are eliminated.
#pragma once

#include "base/memory.h"
#include "cautery/assert.h"
#include "solve/factor.h"
#include "tissue/tissue.h"

typedef struct cau_system {
	int32_t row_count;
	int32_t *row_of_vertex; // (vertex_count): -1 for a pinned vertex
	int32_t *vertex_of_row; // (row_count): vertex of each row
	cau_matrix matrix;      // the pattern has all elements, removed ones too, so it never grows
	double *diagonal;       // (vertex_count): A of the diagonal system (eq. 7), N/m
} cau_system;

// Returns the index of an existing entry of the pattern. `row` ascends from first[column] to
// first[column + 1].
static inline int32_t cau_pattern_place(const int32_t *first, const int32_t *row, int32_t column,
                                        int32_t wanted)
{
	int32_t low = first[column], high = first[column + 1] - 1;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		if (row[middle] < wanted)
			low = middle + 1;
		else
			high = middle;
	}
	CAU_ASSERT(row[low] == wanted, "the pattern has no entry in column %d, row %d", column, wanted);
	return low;
}

// Live elements, by kind (cau_element_kind): byte 1 if the element is live, 0 if it is removed.
typedef struct cau_alive {
	uint8_t *element[CAU_ELEMENT_KINDS];
} cau_alive;

cau_status cau_system_create(cau_system *system, const cau_tissue *tissue, const uint8_t *pinned,
                             cau_arena *arena, cau_error *error);

// Computes the values of A. Elements are added in order, so that equal live sets give equal bits.
void cau_system_assemble(const cau_system *system, const cau_tissue *tissue, const cau_alive *alive,
                         double step_s, double *value);

// Computes the diagonal of eq. 7: M/dt^2 + sum of omega_m, with omega_m = w |G|^2 / vertices.
void cau_system_assemble_diagonal(const cau_system *system, const cau_tissue *tissue,
                                  const cau_alive *alive, double step_s);

// Appends the columns sqrt(w) G^T of an element, in row numbers, to C at column *columns (see
// cau_factor_update). Rows of pinned vertices and all-zero columns are left out.
void cau_system_columns(const cau_system *system, const cau_element_map *map, int32_t *columns,
                        int32_t *first, int32_t *row, double *value);
