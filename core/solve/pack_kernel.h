// SPDX-License-Identifier: GPL-3.0-or-later
// W = [L_s^-1; L_r L_s^-1] of sweep.h from [I; L_r] and L_s, in double, sixteen rows at a time:
//
//     column j of W = column j of [I; L_r] - sum over i > j of L_ij (column i of W)
//
// from the last column back. Rows do not depend on each other, so sixteen of all columns stay in
// the nearest cache until they are done.
#pragma once

#include "base/simd.h"
#include "solve/sweep.h"

enum { PACK_ROWS = 16, PACK_VECTORS = 2 };

typedef double vdouble __attribute__((vector_size(8 * PACK_ROWS / PACK_VECTORS), may_alias));

// Columns [0, last) of the sixteen rows in x, two columns at a time; the later ones are zero there.
INLINE void pack_solve(const double *block, int32_t columns, int32_t last,
                       vdouble (*x)[PACK_VECTORS])
{
	for (int32_t j = last - 1 - last % 2; j > 0; j -= 2) {
		const double *right = block + (int64_t)j * columns, *left = right - columns;
		vdouble a = x[j][0], b = x[j][1], c = x[j - 1][0], d = x[j - 1][1];
		for (int32_t i = j + 1; i < last; ++i) {
			a -= right[i] * x[i][0];
			b -= right[i] * x[i][1];
			c -= left[i] * x[i][0];
			d -= left[i] * x[i][1];
		}
		x[j][0] = a;
		x[j][1] = b;
		x[j - 1][0] = c - left[j] * a;
		x[j - 1][1] = d - left[j] * b;
	}
}

// What W has above its diagonal block's diagonal, and in padded rows, is zero in the panels from
// the start and stays so.
static void pack_node(const cau_supernode *node, const double *block, const double *w,
                      real *forward, real *backward)
{
	vdouble x[CAU_NODE_COLUMNS][PACK_VECTORS];
	int32_t columns = node->columns, rows = columns + node->rows;
	for (int32_t row = 0; row < rows; row += PACK_ROWS) {
		int32_t last = row + PACK_ROWS < columns ? row + PACK_ROWS : columns;
		int32_t count = row + PACK_ROWS < rows ? PACK_ROWS : rows - row;
		for (int32_t j = 0; j < last; ++j)
			memcpy(x[j], w + (int64_t)j * node->padded_rows + row, sizeof x[j]);
		pack_solve(block, columns, last, x);
		for (int32_t j = 0; j < last; ++j) {
			real *out = forward + (int64_t)j * node->padded_rows + row;
			const double *in = (const double *)x[j];
			for (int32_t r = 0; r < PACK_ROWS; ++r)
				out[r] = (real)in[r];
		}
		for (int32_t r = 0; r < count; ++r) {
			real *out = backward + (int64_t)(row + r) * node->padded_columns;
			const double *in = (const double *)x + r;
			for (int32_t j = 0; j < last; ++j)
				out[j] = (real)in[PACK_ROWS * j];
		}
	}
}
