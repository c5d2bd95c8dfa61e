// SPDX-License-Identifier: GPL-3.0-or-later
// Packs one supernode of the factor into the panels of sweep.h. W' = [I - L_s^-1; L_r L_s^-1] is
// computed from [-I; L_r] and L_s, sixteen rows at a time:
//
//     column j of W = column j of [-I; L_r] - sum over i > j of L_ij (column i of W)
//
// Columns are computed from the last to the first. The diagonal of -L_s^-1 is left out, because I
// cancels it. Rows do not depend on each other. So sixteen rows of all columns stay in the nearest
// cache until they are finished.
#pragma once

#include "base/simd.h"
#include "solve/sweep.h"

enum { PACK_ROWS = 16, PACK_VECTORS = PACK_ROWS / LANES, PACK_COLUMNS = 4 };

typedef struct pack_rows {
	vreal v[PACK_VECTORS];
} pack_rows;

// The supernode's columns, dense, by columns. `block` is the diagonal block L_s below its unit
// diagonal (columns x columns). `w` is [-I; L_r] (columns x padded_rows); its padded rows are zero.
typedef struct pack_dense {
	real *block, *w;
} pack_dense;

// Reads the supernode's columns from the factor into the sweep's scratch. Returns the least pivot.
static double pack_gather(const cau_sweep *sweep, const cau_supernode *node,
                          const cau_factor *factor, real *d_inverse, int32_t part,
                          pack_dense *dense)
{
	int32_t columns = node->columns, stride = node->padded_rows;
	int32_t *row_place = sweep->row_place + (int64_t)part * sweep->n;
	dense->block = (real *)sweep->dense + part * sweep->max_dense;
	dense->w = dense->block + (int64_t)columns * columns;
	double least = INFINITY;
	for (int32_t i = 0; i < node->rows; i++)
		row_place[sweep->row_global[node->row + i]] = columns + i;
	memset(dense->block, 0, (size_t)columns * (size_t)(columns + stride) * sizeof(real));
	for (int32_t j = 0; j < columns; j++) {
		const int32_t *row;
		const double *value;
		double pivot;
		real *block = dense->block + (int64_t)j * columns, *w = dense->w + (int64_t)j * stride;
		int32_t count = cau_factor_column(factor, node->first + j, &row, &value, &pivot);
		d_inverse[node->first + j] = (real)(1 / pivot);
		least = fmin(least, pivot);
		w[j] = -1;
		for (int32_t k = 0; k < count; k++) {
			int32_t local = row[k] - node->first;
			if (local < columns)
				block[local] = (real)value[k];
			else
				w[row_place[row[k]]] = (real)value[k];
		}
	}
	return least;
}

// Computes columns last_of - count + 1 to last_of of sixteen rows. Later columns, up to `last`, are
// already computed.
INLINE void pack_columns(const real *block, int32_t columns, int32_t last, int32_t last_of,
                         int count, pack_rows *x)
{
	pack_rows sum[PACK_COLUMNS];
	for (int k = 0; k < count; k++)
		sum[k] = x[last_of - k];
	for (int32_t i = last_of + 1; i < last; i++)
		for (int k = 0; k < count; k++)
			for (int v = 0; v < PACK_VECTORS; v++)
				sum[k].v[v] -= block[(int64_t)(last_of - k) * columns + i] * x[i].v[v];
	for (int k = 0; k < count; k++) {
		x[last_of - k] = sum[k];
		for (int m = k + 1; m < count; m++)
			for (int v = 0; v < PACK_VECTORS; v++)
				sum[m].v[v] -= block[(int64_t)(last_of - m) * columns + last_of - k] * sum[k].v[v];
	}
}

// Replaces w by W'. Returns each column's largest entry in `largest`.
static void pack_multiply(const cau_supernode *node, const pack_dense *dense, real *largest)
{
	pack_rows x[CAU_NODE_COLUMNS];
	vreal most[CAU_NODE_COLUMNS];
	int32_t columns = node->columns, rows = columns + node->rows;
	for (int32_t j = 0; j < columns; j++)
		most[j] = v_set(0);
	for (int32_t row = 0; row < rows; row += PACK_ROWS) {
		int32_t last = row + PACK_ROWS < columns ? row + PACK_ROWS : columns, j = last - 1;
		for (int32_t k = 0; k < last; k++)
			memcpy(&x[k], dense->w + (int64_t)k * node->padded_rows + row, sizeof x[k]);
		for (; (j + 1) % PACK_COLUMNS; j--)
			pack_columns(dense->block, columns, last, j, 1, x);
		for (; j > 0; j -= PACK_COLUMNS)
			pack_columns(dense->block, columns, last, j, PACK_COLUMNS, x);
		for (int32_t k = row; k < last; k++)
			((real *)&x[k])[k - row] = 0;
		for (int32_t k = 0; k < last; k++) {
			for (int v = 0; v < PACK_VECTORS; v++)
				most[k] = v_max(most[k], v_abs(x[k].v[v]));
			memcpy(dense->w + (int64_t)k * node->padded_rows + row, &x[k], sizeof x[k]);
		}
	}
	for (int32_t j = 0; j < columns; j++) {
		largest[j] = 0;
		for (int l = 0; l < LANES; l++)
			largest[j] = most[j][l] > largest[j] ? most[j][l] : largest[j];
	}
}

// Stores sixteen entries of W'. Narrow entries of a column have one scale: its largest entry over
// NARROW_MOST.
INLINE void pack_store(const real *in, real inverse_scale, void *out, bool narrow)
{
	// an offset that makes the value positive and half a unit larger: truncation then rounds
	const real up = NARROW_MOST + (real)1.5;
	for (int v = 0; v < PACK_VECTORS; v++) {
		vreal w = v_load(in, v * LANES);
		if (narrow) {
			vmask whole = __builtin_convertvector(w * inverse_scale + up, vmask);
			((narrow_lanes *)out)[v] =
				__builtin_convertvector(whole - (NARROW_MOST + 1), narrow_lanes);
		} else {
			v_store(out, v * LANES, w);
		}
	}
}

// Packs one supernode. Entries of W' on and above the diagonal of its diagonal block, and in padded
// rows, are zero in new panels and are not written. Returns the least pivot.
static double pack_node(const cau_sweep *sweep, const cau_supernode *node, const cau_factor *factor,
                        const cau_sweep_panels *panels, int32_t part)
{
	bool narrow = sweep->narrow;
	char *panel = (char *)panels->panel + (size_t)node->panel * cau_sweep_entry_bytes(sweep);
	real inverse[CAU_NODE_COLUMNS], *scale = (real *)panels->scale + node->first;
	int32_t columns = node->columns, rows = columns + node->rows;
	pack_dense dense;
	double least = pack_gather(sweep, node, factor, (real *)panels->d_inverse, part, &dense);
	pack_multiply(node, &dense, inverse);
	for (int32_t j = 0; j < columns; j++) {
		scale[j] = narrow ? inverse[j] / NARROW_MOST : 1;
		inverse[j] = inverse[j] > REAL_TINY ? NARROW_MOST / inverse[j] : 0;
	}
	for (int32_t row = 0; row < rows; row += PACK_ROWS) {
		int32_t last = row + PACK_ROWS < columns ? row + PACK_ROWS : columns;
		for (int32_t j = 0; j < last; j++) {
			int64_t entry = (int64_t)j * node->padded_rows + row;
			pack_store(dense.w + entry, inverse[j],
			           panel + (size_t)entry * cau_sweep_entry_bytes(sweep), narrow);
		}
	}
	return least;
}
