// SPDX-License-Identifier: GPL-3.0-or-later
// The dense products of sweep.h, for three right-hand sides at once.
#pragma once

#include "base/simd.h"
#include "solve/sweep.h"

enum {
	SWEEP_BLOCK = 4
}; // vectors of rows (or columns) worked on together, to share the broadcasts

// out (3 x stride) = W b for rows [block, block + vectors * LANES) of a panel by columns.
INLINE void panel_rows(const real *panel, int32_t padded_rows, int32_t columns, const real *b[3],
                       int32_t row, int vectors, real *out, int32_t stride)
{
	vreal sum[3][SWEEP_BLOCK];
	for (int c = 0; c < 3; ++c)
		for (int k = 0; k < vectors; ++k)
			sum[c][k] = v_set(0);
	for (int32_t j = 0; j < columns; ++j) {
		const real *column = panel + (int64_t)j * padded_rows + row;
		vreal x = v_set(b[0][j]), y = v_set(b[1][j]), z = v_set(b[2][j]);
		for (int k = 0; k < vectors; ++k) {
			vreal w = v_load(column, k * LANES);
			sum[0][k] += w * x;
			sum[1][k] += w * y;
			sum[2][k] += w * z;
		}
	}
	for (int c = 0; c < 3; ++c)
		for (int k = 0; k < vectors; ++k)
			v_store(out + (int64_t)c * stride + row, k * LANES, sum[c][k]);
}

static void panel_multiply(const real *panel, int32_t padded_rows, int32_t columns,
                           const real *b[3], real *out, int32_t stride)
{
	int32_t row = 0;
	for (; row + SWEEP_BLOCK * LANES <= padded_rows; row += SWEEP_BLOCK * LANES)
		panel_rows(panel, padded_rows, columns, b, row, SWEEP_BLOCK, out, stride);
	for (; row < padded_rows; row += LANES)
		panel_rows(panel, padded_rows, columns, b, row, 1, out, stride);
}

// The supernode's part of the forward sweep. `above` holds the task's sums for the rows above it
// (NULL for supernodes above the tasks). `work` has 3 x max_rows reals.
static void sweep_forward_node(const cau_sweep *sweep, const cau_supernode *node,
                               real *const rhs[3], real *const above[3], real *work)
{
	const real *b[3] = {rhs[0] + node->first, rhs[1] + node->first, rhs[2] + node->first};
	int32_t stride = sweep->max_rows;
	panel_multiply((const real *)sweep->forward + node->forward, node->padded_rows, node->columns,
	               b, work, stride);
	const int32_t *row = sweep->row_index + node->row;
	for (int c = 0; c < 3; ++c) {
		const real *out = work + (int64_t)c * stride;
		for (int32_t i = 0; i < node->columns; ++i)
			rhs[c][node->first + i] = out[i];
		out += node->columns;
		for (int32_t i = 0; i < node->inner_rows; ++i)
			rhs[c][row[i]] -= out[i];
		for (int32_t i = node->inner_rows; i < node->rows; ++i)
			above[c][row[i]] += out[i];
	}
}

// The supernode's part of the backward sweep: rhs holds y on entry of its columns, x on return.
static void sweep_backward_node(const cau_sweep *sweep, const cau_supernode *node,
                                real *const rhs[3], real *work)
{
	const int32_t *row = sweep->row_global + node->row;
	const real *d = (const real *)sweep->d_inverse + node->first;
	int32_t stride = sweep->max_rows, rows = node->columns + node->rows;
	for (int c = 0; c < 3; ++c) {
		real *in = work + (int64_t)c * stride;
		for (int32_t i = 0; i < node->columns; ++i)
			in[i] = d[i] * rhs[c][node->first + i];
		for (int32_t i = 0; i < node->rows; ++i)
			in[node->columns + i] = -rhs[c][row[i]];
	}
	const real *b[3] = {work, work + stride, work + 2 * (int64_t)stride};
	real *out = work + 3 * (int64_t)stride;
	panel_multiply((const real *)sweep->backward + node->backward, node->padded_columns, rows, b,
	               out, sweep->max_columns);
	for (int c = 0; c < 3; ++c)
		for (int32_t i = 0; i < node->columns; ++i)
			rhs[c][node->first + i] = out[(int64_t)c * sweep->max_columns + i];
}
