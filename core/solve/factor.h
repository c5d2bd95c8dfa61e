// SPDX-License-Identifier: GPL-3.0-or-later
// An interface to CHOLMOD: fill-reducing order, simplicial L D L^T, rank-k updates and downdates.
// Simplicial factors need no BLAS, so the bits depend only on the order of operations.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "cautery/status.h"

typedef struct cau_factor cau_factor;

enum {
	CAU_UPDATE_RANK = 8,  // most columns of one update
	CAU_FACTOR_PARTS = 9, // arrays of a factor
};

// Symmetric matrix: lower triangle by columns, rows ascending, with the diagonal.
typedef struct cau_matrix {
	int32_t n;
	int32_t *first; // (n + 1): start of each column
	int32_t *row;   // (first[n]): row of each entry
	double *value;  // (first[n]): value of each entry
} cau_matrix;

// Orders `matrix` and finds the factor's pattern, without its values. `permutation` (n) is an order
// to use. If it is NULL, METIS finds one by nested dissection, under a lock because libmetis uses
// rand. Call cau_factor_refactor next.
cau_status cau_factor_analyse(cau_factor **factor, const cau_matrix *matrix,
                              const int32_t *permutation, cau_error *error);
// Analyses and factors. CAU_NUMERICAL: `matrix` is not positive definite.
cau_status cau_factor_create(cau_factor **factor, const cau_matrix *matrix,
                             const int32_t *permutation, cau_error *error);
// Returns the number of entries of L with the diagonal. Valid after the analysis.
int64_t cau_factor_entries(const cau_factor *factor);
void cau_factor_destroy(cau_factor *factor); // accepts NULL

// Computes the factor again with the same pattern. The result is canonical: its bits depend on the
// values alone. May run on any thread. Meanwhile other threads may read the order, and nothing
// else.
cau_status cau_factor_refactor(cau_factor *factor, const cau_matrix *matrix, cau_error *error);

// True if the factor is the result of cau_factor_refactor without later updates.
bool cau_factor_is_canonical(const cau_factor *factor);

// A <- A + C C^T (add) or A - C C^T. C has `columns` sparse columns, in the row numbers of A:
// column k has rows row[first[k] .. first[k+1]). The pattern of C C^T must lie inside that of A.
cau_status cau_factor_update(cau_factor *factor, int32_t columns, const int32_t *first,
                             const int32_t *row, const double *value, int add, cau_error *error);

int32_t cau_factor_size(const cau_factor *factor);
// (n): row k of L is row permutation[k] of A
const int32_t *cau_factor_permutation(const cau_factor *factor);
const int32_t *cau_factor_places(const cau_factor *factor); // (n): index in L of each row of A
// Returns the number of entries of column j of L below the diagonal, with their rows (ascending)
// and values. *pivot is D_jj. The arrays are valid until the next operation.
int32_t cau_factor_column(const cau_factor *factor, int32_t j, const int32_t **row,
                          const double **value, double *pivot);
double cau_factor_least_pivot(const cau_factor *factor);

// Reference solve in double: x = A^-1 b for three columns of n each (b and x are n x 3,
// column-major). Only the first call allocates memory.
cau_status cau_factor_solve(cau_factor *factor, const double *b, double *x, cau_error *error);

// Fills in the pages of the factor's arrays (CAU_FACTOR_PARTS); empty for a small array. Returns
// their number. The pages are valid until the next operation.
int32_t cau_factor_pages(const cau_factor *factor, cau_pages *pages);
