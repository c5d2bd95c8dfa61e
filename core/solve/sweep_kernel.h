// SPDX-License-Identifier: GPL-3.0-or-later
// The dense products of sweep.h, for the three coordinates at once. A vector's lanes are rows of a
// panel by columns (forward), columns of one by rows (backward).
#pragma once

#include "base/simd.h"
#include "solve/sweep.h"

enum {
	SWEEP_BLOCK = 4, // vectors worked on together, to share what is broadcast
	SWEEP_STEP = SWEEP_BLOCK * LANES,
	SWEEP_AHEAD = 16, // columns or rows that are asked for early
};

// Asks for a panel's column (forward) or row (backward) that comes later: they are too far apart
// for processors to see them coming.
INLINE void sweep_prefetch(const stored_real *panel, int vectors)
{
	enum { LINE = 64 / sizeof(stored_real), STEP = LANES < LINE ? LINE : LANES };
	for (int k = 0; k < vectors * LANES; k += STEP)
		__builtin_prefetch(panel + k);
}

// sum[k] += panel[k] * at, of one column (forward) or row (backward), vectors [first, last).
INLINE void sweep_add(v3 sum[SWEEP_BLOCK], const stored_real *panel, const real *at, int first,
                      int last)
{
	vreal x = v_set(at[0]), y = v_set(at[1]), z = v_set(at[2]);
	for (int k = first; k < last; ++k) {
		vreal w = v_load_stored(panel + k * LANES);
		sum[k].x += w * x;
		sum[k].y += w * y;
		sum[k].z += w * z;
	}
}

INLINE void sweep_subtract(real *field, const int32_t *place, v3 sum)
{
	v3_add_to_wide(field, place, (v3){-sum.x, -sum.y, -sum.z});
}

INLINE int32_t least(int32_t a, int32_t b)
{
	return a < b ? a : b;
}

// Columns [j, that of the last row of vector k]: there vectors from k on have entries. Returns the
// next column.
INLINE int32_t forward_columns(v3 sum[SWEEP_BLOCK], const stored_real *panel,
                               const cau_supernode *node, const real *b, int32_t row, int32_t j,
                               int k, int vectors)
{
	int32_t end = k < vectors ? least(node->columns, row + (k + 1) * LANES) : j;
	for (; j < end; ++j) {
		sweep_prefetch(panel + (int64_t)(j + SWEEP_AHEAD) * node->padded_rows, vectors);
		sweep_add(sum, panel + (int64_t)j * node->padded_rows, b + 4 * j, k, vectors);
	}
	return j;
}

// Rows [row, row + vectors x LANES) take W' y off; b is y in steps of the columns' scales.
INLINE void forward_rows(const cau_sweep *sweep, const cau_supernode *node, const real *b,
                         int32_t row, int vectors)
{
	const stored_real *panel = (const stored_real *)sweep->forward + node->forward + row;
	v3 sum[SWEEP_BLOCK];
	for (int k = 0; k < vectors; ++k)
		sum[k] = v3_zero();
	int32_t j = forward_columns(sum, panel, node, b, row, 0, 0, vectors);
	j = forward_columns(sum, panel, node, b, row, j, 1, vectors);
	j = forward_columns(sum, panel, node, b, row, j, 2, vectors);
	forward_columns(sum, panel, node, b, row, j, 3, vectors);
	const int32_t *place = sweep->forward_place + node->place + row;
	for (int k = 0; k < vectors; ++k)
		sweep_subtract(sweep->field, place + k * LANES, sum[k]);
}

// The supernode's part of the forward sweep.
static void sweep_forward_node(const cau_sweep *sweep, const cau_supernode *node)
{
	const real *scale = (const real *)sweep->scale + node->first;
	const real *own = (const real *)sweep->field + 4 * (int64_t)node->first;
	real b[4 * CAU_NODE_COLUMNS] __attribute__((aligned(64)));
	for (int32_t j = 0; j < node->columns; ++j)
		for (int c = 0; c < 4; ++c)
			b[4 * j + c] = scale[j] * own[4 * (int64_t)j + c];
	int32_t row = 0;
	for (; row + SWEEP_STEP <= node->padded_rows; row += SWEEP_STEP)
		forward_rows(sweep, node, b, row, SWEEP_BLOCK);
	switch ((node->padded_rows - row) / LANES) {
	case 3:
		forward_rows(sweep, node, b, row, 3);
		break;
	case 2:
		forward_rows(sweep, node, b, row, 2);
		break;
	case 1:
		forward_rows(sweep, node, b, row, 1);
		break;
	default:
		break;
	}
}

// Rows [i, the last where the vectors after k have nothing yet]. Returns the next row.
INLINE int32_t backward_rows(v3 sum[SWEEP_BLOCK], const cau_sweep *sweep, const cau_supernode *node,
                             int32_t column, int32_t i, int k, int vectors)
{
	const int32_t rows = node->columns + node->rows;
	const int32_t *place = sweep->backward_place + node->place;
	const stored_real *panel = (const stored_real *)sweep->backward + node->backward + column;
	int32_t end = k + 1 < vectors ? least(rows, column + (k + 1) * LANES) : rows;
	for (; k < vectors && i < end; ++i) {
		sweep_prefetch(panel + (int64_t)(i + SWEEP_AHEAD) * node->padded_columns, vectors);
		sweep_add(sum, panel + (int64_t)i * node->padded_columns,
		          (const real *)sweep->field + place[i], 0, k + 1);
	}
	return i;
}

// Columns [column, column + vectors x LANES) take W'^T [D^-1 y; x] off.
INLINE void backward_columns(const cau_sweep *sweep, const cau_supernode *node, int32_t column,
                             int vectors)
{
	v3 sum[SWEEP_BLOCK];
	for (int k = 0; k < vectors; ++k)
		sum[k] = v3_zero();
	int32_t i = backward_rows(sum, sweep, node, column, column, 0, vectors);
	i = backward_rows(sum, sweep, node, column, i, 1, vectors);
	i = backward_rows(sum, sweep, node, column, i, 2, vectors);
	backward_rows(sum, sweep, node, column, i, 3, vectors);
	const real *scale = (const real *)sweep->scale + node->first + column;
	for (int k = 0; k < vectors; ++k) {
		int32_t place[LANES];
		for (int l = 0; l < LANES; ++l) {
			int32_t c = column + k * LANES + l;
			place[l] = c < node->columns ? 4 * (node->first + c) : node->spare;
		}
		sweep_subtract(sweep->field, place, v3_scale(v_load(scale, k * LANES), sum[k]));
	}
}

// The supernode's part of the backward sweep: its columns hold y on entry, x on return. A block
// reads rows from its own first on, and writes its columns: the blocks after it do not read those.
static void sweep_backward_node(const cau_sweep *sweep, const cau_supernode *node)
{
	const real *d = (const real *)sweep->d_inverse + node->first;
	real *own = (real *)sweep->field + 4 * (int64_t)node->first;
	for (int32_t i = 0; i < node->columns; ++i)
		for (int c = 0; c < 4; ++c)
			own[4 * (int64_t)i + c] *= d[i];
	int32_t column = 0;
	for (; column + SWEEP_STEP <= node->padded_columns; column += SWEEP_STEP)
		backward_columns(sweep, node, column, SWEEP_BLOCK);
	switch ((node->padded_columns - column) / LANES) {
	case 3:
		backward_columns(sweep, node, column, 3);
		break;
	case 2:
		backward_columns(sweep, node, column, 2);
		break;
	case 1:
		backward_columns(sweep, node, column, 1);
		break;
	default:
		break;
	}
}
