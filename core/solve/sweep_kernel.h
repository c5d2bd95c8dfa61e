// SPDX-License-Identifier: GPL-3.0-or-later
// The dense products of sweep.h, for the three coordinates at once. A vector's lanes are rows of a
// column of the panel.
#pragma once

#include "base/simd.h"
#include "solve/sweep.h"

enum {
	SWEEP_BLOCK = 4,    // columns worked on together
	SWEEP_TILE = 512,   // rows worked on together
	SWEEP_AHEAD = 8192, // bytes between what is read and what is asked for
};

// What a tile of rows takes (forward) or holds (backward).
typedef struct sweep_tile {
	v3 rows[SWEEP_TILE / LANES];
} sweep_tile;

// Asks for `count` entries `ahead` bytes behind `panel`: processors see some way ahead, but not as
// far, and less when it goes down.
INLINE void sweep_prefetch(const stored_real *panel, intptr_t ahead, int64_t count)
{
	enum { LINE = 64 };
	for (intptr_t k = 0; k < (intptr_t)sizeof *panel * count; k += LINE)
		__builtin_prefetch((const void *)((intptr_t)panel + ahead + k));
}

// Of a tile that begins with `row`, the first vector that has entries in columns from `column` on.
INLINE int sweep_first(int32_t row, int32_t column)
{
	return row ? 0 : column / LANES;
}

INLINE void sweep_subtract(real *field, const int32_t *place, v3 sum)
{
	v3_add_to_wide(field, place, (v3){-sum.x, -sum.y, -sum.z});
}

INLINE int32_t least(int32_t a, int32_t b)
{
	return a < b ? a : b;
}

// Adds W' b of `count` columns to rows; `panel` is the first column at the first of the tile's
// rows, vectors [first, last) of which have entries there.
INLINE void forward_columns(const stored_real *panel, int64_t stride, sweep_tile *tile, int first,
                            int last, const real *b, int count)
{
	v3 at[SWEEP_BLOCK];
	sweep_prefetch(panel, SWEEP_AHEAD, count * stride);
	for (int j = 0; j < count; ++j)
		at[j] = (v3){v_set(b[4 * j]), v_set(b[4 * j + 1]), v_set(b[4 * j + 2])};
	for (int k = first; k < last; ++k) {
		v3 sum = tile->rows[k];
		for (int j = 0; j < count; ++j)
			sum = v3_add_scaled(sum, v_load_stored(panel + j * stride + k * LANES), at[j]);
		tile->rows[k] = sum;
	}
}

// Rows [row, row + vectors x LANES) take W' b off; b is in steps of the columns' scales.
static void forward_tile(const cau_sweep *sweep, const cau_supernode *node, int32_t row,
                         int vectors, const real *b)
{
	const stored_real *panel = (const stored_real *)sweep->panel + node->panel + row;
	int64_t stride = node->padded_rows;
	sweep_tile tile;
	for (int k = 0; k < vectors; ++k)
		tile.rows[k] = v3_zero();
	int32_t j = 0;
	for (; j + SWEEP_BLOCK <= node->columns; j += SWEEP_BLOCK)
		forward_columns(panel + j * stride, stride, &tile, sweep_first(row, j), vectors, b + 4 * j,
		                SWEEP_BLOCK);
	for (; j < node->columns; ++j)
		forward_columns(panel + j * stride, stride, &tile, sweep_first(row, j), vectors, b + 4 * j,
		                1);
	const int32_t *place = sweep->forward_place + node->place + row;
	for (int k = 0; k < vectors; ++k)
		sweep_subtract(sweep->field, place + k * LANES, tile.rows[k]);
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
	for (int32_t row = 0; row < node->padded_rows; row += SWEEP_TILE)
		forward_tile(sweep, node, row, least(SWEEP_TILE, node->padded_rows - row) / LANES, b);
}

// Columns [column, column + count) take theirs of W'^T [D^-1 y; x] off, of vectors [first, last) of
// rows; `panel` is the first column at the first of the tile's rows.
INLINE void backward_columns(const stored_real *panel, int64_t stride, const sweep_tile *tile,
                             int first, int last, const real *scale, real *column, int count)
{
	v3 sum[SWEEP_BLOCK];
	sweep_prefetch(panel, -SWEEP_AHEAD, count * stride);
	for (int j = 0; j < count; ++j)
		sum[j] = v3_zero();
	for (int k = first; k < last; ++k)
		for (int j = 0; j < count; ++j)
			sum[j] =
				v3_add_scaled(sum[j], v_load_stored(panel + j * stride + k * LANES), tile->rows[k]);
	for (int j = 0; j < count; ++j)
		v3_subtract_total(column + 4 * j, scale[j], sum[j]);
}

// What all columns take off of rows [row, row + vectors x LANES), from the last column back, as the
// supernodes are taken: the panels are read straight down.
static void backward_tile(const cau_sweep *sweep, const cau_supernode *node, int32_t row,
                          int vectors, real *own)
{
	const int32_t *place = sweep->backward_place + node->place + row;
	const stored_real *panel = (const stored_real *)sweep->panel + node->panel + row;
	const real *scale = (const real *)sweep->scale + node->first;
	int64_t stride = node->padded_rows;
	sweep_tile tile;
	for (int k = 0; k < vectors; ++k)
		tile.rows[k] = v3_gather_wide(sweep->field, place + k * LANES);
	int32_t j = node->columns;
	while (j % SWEEP_BLOCK) {
		--j;
		backward_columns(panel + j * stride, stride, &tile, sweep_first(row, j), vectors, scale + j,
		                 own + 4 * j, 1);
	}
	while (j) {
		j -= SWEEP_BLOCK;
		backward_columns(panel + j * stride, stride, &tile, sweep_first(row, j), vectors, scale + j,
		                 own + 4 * j, SWEEP_BLOCK);
	}
}

// The supernode's part of the backward sweep: its columns hold y on entry, x on return. All its
// columns are rows of the first tile, which is read before any of them is written.
static void sweep_backward_node(const cau_sweep *sweep, const cau_supernode *node)
{
	const real *d = (const real *)sweep->d_inverse + node->first;
	real *own = (real *)sweep->field + 4 * (int64_t)node->first;
	for (int32_t i = 0; i < node->columns; ++i)
		for (int c = 0; c < 4; ++c)
			own[4 * (int64_t)i + c] *= d[i];
	for (int32_t row = 0; row < node->padded_rows; row += SWEEP_TILE)
		backward_tile(sweep, node, row, least(SWEEP_TILE, node->padded_rows - row) / LANES, own);
}
