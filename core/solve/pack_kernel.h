// SPDX-License-Identifier: GPL-3.0-or-later
// W' = [I - L_s^-1; L_r L_s^-1] of sweep.h from [-I; L_r] and L_s, in double, sixteen rows at a
// time:
//
//     column j of W = column j of [-I; L_r] - sum over i > j of L_ij (column i of W)
//
// but for the diagonal of -L_s^-1, which I takes away.
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

enum { PACK_LANES = PACK_ROWS / PACK_VECTORS };
typedef int64_t vdouble_mask __attribute__((vector_size(8 * PACK_LANES)));

INLINE vdouble pack_larger(vdouble a, vdouble b)
{
	vdouble size = (vdouble)((vdouble_mask)b & INT64_MAX);
	vdouble_mask m = a > size;
	return (vdouble)((m & (vdouble_mask)a) | (~m & (vdouble_mask)size));
}

// Entries of W' as they are stored: all of a column by one scale, its largest entry over
// STORED_MOST.
INLINE void pack_store(const double *in, double inverse_scale, stored_real *out)
{
#if CAU_SINGLE
	typedef int32_t vint __attribute__((vector_size(4 * PACK_LANES)));
	typedef int16_t vshort __attribute__((vector_size(2 * PACK_LANES), may_alias, aligned(2)));
	const vint zero = {0};
	for (int v = 0; v < PACK_VECTORS; ++v) {
		vdouble x;
		memcpy(&x, in + v * PACK_LANES, sizeof x);
		vdouble steps = x * inverse_scale + (STORED_MOST + 1.5); // rounds
		vint whole = __builtin_convertvector(steps, vint) - (zero + (STORED_MOST + 1));
		*(vshort *)(out + v * PACK_LANES) = __builtin_convertvector(whole, vshort);
	}
#else
	(void)inverse_scale;
	memcpy(out, in, PACK_ROWS * sizeof *out);
#endif
}

// W' in double, in the place of w. Returns each column's largest entry.
static void pack_multiply(const cau_supernode *node, const double *block, double *w,
                          double *largest)
{
	vdouble x[CAU_NODE_COLUMNS][PACK_VECTORS], most[CAU_NODE_COLUMNS] = {{0}};
	int32_t columns = node->columns, rows = columns + node->rows;
	for (int32_t row = 0; row < rows; row += PACK_ROWS) {
		int32_t last = row + PACK_ROWS < columns ? row + PACK_ROWS : columns;
		for (int32_t j = 0; j < last; ++j)
			memcpy(x[j], w + (int64_t)j * node->padded_rows + row, sizeof x[j]);
		pack_solve(block, columns, last, x);
		for (int32_t j = row; j < last; ++j)
			((double *)x[j])[j - row] = 0;
		for (int32_t j = 0; j < last; ++j) {
			most[j] = pack_larger(pack_larger(most[j], x[j][0]), x[j][1]);
			memcpy(w + (int64_t)j * node->padded_rows + row, x[j], sizeof x[j]);
		}
	}
	for (int32_t j = 0; j < columns; ++j) {
		largest[j] = 0;
		for (int l = 0; l < PACK_LANES; ++l)
			largest[j] = most[j][l] > largest[j] ? most[j][l] : largest[j];
	}
}

// What W' has on and above its diagonal block's diagonal, and in padded rows, is zero in the panels
// from the start and stays so.
static void pack_node(const cau_supernode *node, const double *block, double *w,
                      stored_real *forward, stored_real *backward, real *scale)
{
	double inverse[CAU_NODE_COLUMNS];
	int32_t columns = node->columns, rows = columns + node->rows;
	pack_multiply(node, block, w, inverse);
	for (int32_t j = 0; j < columns; ++j) {
		scale[j] = STORED_MOST ? (real)(inverse[j] / STORED_MOST) : 1;
		inverse[j] = inverse[j] > REAL_TINY ? STORED_MOST / inverse[j] : 0;
	}
	for (int32_t row = 0; row < rows; row += PACK_ROWS) {
		int32_t last = row + PACK_ROWS < columns ? row + PACK_ROWS : columns;
		int32_t count = row + PACK_ROWS < rows ? PACK_ROWS : rows - row;
		for (int32_t j = 0; j < last; ++j)
			pack_store(w + (int64_t)j * node->padded_rows + row, inverse[j],
			           forward + (int64_t)j * node->padded_rows + row);
		for (int32_t r = 0; r < count; ++r) {
			stored_real *out = backward + (int64_t)(row + r) * node->padded_columns;
			const stored_real *in = forward + row + r;
			for (int32_t j = 0; j < last; ++j)
				out[j] = in[(int64_t)j * node->padded_rows];
		}
	}
}
