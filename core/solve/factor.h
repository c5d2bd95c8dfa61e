// SPDX-License-Identifier: GPL-3.0-or-later
// CHOLMOD behind one door: fill-reducing order, simplicial L D L^T, rank-k updates and downdates.
// Simplicial, so no BLAS is involved and the bits depend on nothing but the operations' order.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/pages.h"
#include "cautery/status.h"

typedef struct cau_factor cau_factor;

enum {
	CAU_UPDATE_RANK = 8,  // columns of one update at most
	CAU_FACTOR_PARTS = 9, // arrays that it is made of
};

// Symmetric matrix, lower triangle by columns, rows ascending, diagonal present.
typedef struct cau_matrix {
	int32_t n;
	int32_t *first; // (n + 1)
	int32_t *row;   // (first[n])
	double *value;  // (first[n])
} cau_matrix;

// Orders `matrix` and finds the factor's pattern, without a number. `permutation` (n) gives an
// order to use, NULL asks for one (METIS nested dissection, under a lock: libmetis draws from
// rand). cau_factor_refactor comes next.
cau_status cau_factor_analyse(cau_factor **factor, const cau_matrix *matrix,
                              const int32_t *permutation, cau_error *error);
// Both. CAU_NUMERICAL: not positive definite.
cau_status cau_factor_create(cau_factor **factor, const cau_matrix *matrix,
                             const int32_t *permutation, cau_error *error);
// Entries of L, the diagonal among them; known once it is analysed.
int64_t cau_factor_entries(const cau_factor *factor);
void cau_factor_destroy(cau_factor *factor); // takes NULL

// Numeric factorisation anew with the same pattern: canonical, its bits depend on the values alone.
// On any thread; the order may be read meanwhile, nothing else.
cau_status cau_factor_refactor(cau_factor *factor, const cau_matrix *matrix, cau_error *error);

// Whether it is as cau_factor_refactor left it: nothing was added or taken out since.
bool cau_factor_is_canonical(const cau_factor *factor);

// A <- A + C C^T (add) or A - C C^T, C of `columns` sparse columns in the matrix's own row numbers:
// column k has rows row[first[k] .. first[k+1]). The pattern of C C^T must lie inside that of A.
cau_status cau_factor_update(cau_factor *factor, int32_t columns, const int32_t *first,
                             const int32_t *row, const double *value, int add, cau_error *error);

int32_t cau_factor_size(const cau_factor *factor);
const int32_t *cau_factor_permutation(const cau_factor *factor); // (n): row k of L is row p[k] of A
const int32_t *cau_factor_places(const cau_factor *factor);      // (n): place in L of each row of A
// Column j of L below the diagonal, rows ascending; *pivot is D_jj. Borrowed until the next
// operation.
int32_t cau_factor_column(const cau_factor *factor, int32_t j, const int32_t **row,
                          const double **value, double *pivot);
double cau_factor_least_pivot(const cau_factor *factor);

// Reference solve in double, x = A^-1 b for three columns each of n (b and x n x 3 column-major).
// Allocates on first use only.
cau_status cau_factor_solve(cau_factor *factor, const double *b, double *x, cau_error *error);

// The pages of its arrays (CAU_FACTOR_PARTS), empty where an array is small; returns how many.
// Borrowed until the next operation.
int32_t cau_factor_pages(const cau_factor *factor, cau_pages *pages);
