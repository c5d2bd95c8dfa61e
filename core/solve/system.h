// SPDX-License-Identifier: GPL-3.0-or-later
// The global system A = M/dt^2 + sum of w G^T G over the live elements. One
// row a free vertex; x, y and z share it. Pinned vertices are eliminated.
#pragma once

#include "base/memory.h"
#include "cautery/assert.h"
#include "solve/factor.h"
#include "tissue/tissue.h"

typedef struct cau_system {
	int32_t row_count;
	int32_t *row_of_vertex; // (vertex_count), -1 where pinned
	int32_t *vertex_of_row; // (row_count)
	cau_matrix matrix;      // pattern of all elements, dead ones too, so it never grows
	double *diagonal;       // (vertex_count): A of the diagonal system (eq. 7), N/m
} cau_system;

// Place of an entry that a pattern has: `row` ascends from first[column] to first[column + 1].
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

// Which elements live, as bytes 0/1 by kind (cau_element_kind).
typedef struct cau_alive {
	uint8_t *element[CAU_ELEMENT_KINDS];
} cau_alive;

cau_status cau_system_create(cau_system *system, const cau_tissue *tissue, const uint8_t *pinned,
                             cau_arena *arena, cau_error *error);

// Values of A from scratch, elements in order: equal bits for equal live sets.
void cau_system_assemble(const cau_system *system, const cau_tissue *tissue, const cau_alive *alive,
                         double step_s, double *value);

// The diagonal of eq. 7: M/dt^2 + sum of omega_m, omega_m = w |G|^2 / vertices.
void cau_system_assemble_diagonal(const cau_system *system, const cau_tissue *tissue,
                                  const cau_alive *alive, double step_s);

// Columns sqrt(w) G^T of an element in row numbers, appended to C at column *columns (see
// cau_factor_update). Rows of pinned vertices are left out; all-zero columns too.
void cau_system_columns(const cau_system *system, const cau_element_map *map, int32_t *columns,
                        int32_t *first, int32_t *row, double *value);
