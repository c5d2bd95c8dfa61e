// SPDX-License-Identifier: GPL-3.0-or-later
// The dense products of sweep.h, for the three coordinates at once. The lanes of a vector are rows
// of one column of the panel.
#pragma once

#include "base/simd.h"
#include "solve/sweep.h"

enum {
	SWEEP_BLOCK = 4,    // columns that are processed together
	SWEEP_TILE = 512,   // rows that are processed together
	SWEEP_AHEAD = 8192, // bytes from the address that is read to the address that is prefetched
};

// The sums for a tile of rows (forward), or their values (backward).
typedef struct sweep_tile {
	v3 rows[SWEEP_TILE / LANES];
} sweep_tile;

// A supernode's panel from a row and column on: reals, or narrow entries.
typedef struct sweep_panel {
	const void *at;
	int64_t stride; // entries in a column
	bool narrow;
} sweep_panel;

INLINE const void *panel_at(sweep_panel panel, int64_t entry)
{
	return (const char *)panel.at +
	       entry * (int64_t)(panel.narrow ? sizeof(int16_t) : sizeof(real));
}

INLINE sweep_panel panel_from(sweep_panel panel, int64_t entry)
{
	return (sweep_panel){panel_at(panel, entry), panel.stride, panel.narrow};
}

INLINE vreal panel_load(sweep_panel panel, int64_t entry)
{
	const void *from = panel_at(panel, entry);
	return panel.narrow ? v_load_narrow(from) : v_load(from, 0);
}

INLINE sweep_panel panel_of(const cau_sweep *sweep, const cau_supernode *node, int32_t row,
                            bool narrow)
{
	return panel_from((sweep_panel){sweep->panel, node->padded_rows, narrow}, node->panel + row);
}

// Prefetches `count` columns, `ahead` bytes after the first. Processors prefetch by themselves, but
// not as far, and less if addresses descend.
INLINE void sweep_prefetch(sweep_panel panel, intptr_t ahead, int count)
{
	enum { LINE = 64 };
	const char *last = panel_at(panel, count * panel.stride);
	for (const char *at = panel.at; at < last; at += LINE)
		__builtin_prefetch((const void *)((intptr_t)at + ahead));
}

// In a tile that begins with `row`, returns the first vector that has entries in columns from
// `column` on.
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

// Adds W' b of `count` columns to the tile. `panel` is at the first column and the tile's first
// row. Vectors [first, last) of the tile have entries.
INLINE void forward_columns(sweep_panel panel, sweep_tile *tile, int first, int last, const real *b,
                            int count)
{
	v3 at[SWEEP_BLOCK];
	sweep_prefetch(panel, SWEEP_AHEAD, count);
	for (int j = 0; j < count; j++)
		at[j] = (v3){v_set(b[4 * j]), v_set(b[4 * j + 1]), v_set(b[4 * j + 2])};
	for (int k = first; k < last; k++) {
		v3 sum = tile->rows[k];
		for (int j = 0; j < count; j++)
			sum = v3_add_scaled(sum, panel_load(panel, j * panel.stride + k * LANES), at[j]);
		tile->rows[k] = sum;
	}
}

// Subtracts W' b from rows [row, row + vectors x LANES). `b` is already multiplied by the columns'
// scales.
INLINE void forward_tile(const cau_sweep *sweep, const cau_supernode *node, bool narrow,
                         int32_t row, int vectors, const real *b)
{
	sweep_panel panel = panel_of(sweep, node, row, narrow);
	sweep_tile tile;
	for (int k = 0; k < vectors; k++)
		tile.rows[k] = v3_zero();
	int32_t j = 0;
	for (; j + SWEEP_BLOCK <= node->columns; j += SWEEP_BLOCK)
		forward_columns(panel_from(panel, j * panel.stride), &tile, sweep_first(row, j), vectors,
		                b + 4 * j, SWEEP_BLOCK);
	for (; j < node->columns; j++)
		forward_columns(panel_from(panel, j * panel.stride), &tile, sweep_first(row, j), vectors,
		                b + 4 * j, 1);
	const int32_t *place = sweep->forward_place + node->place + row;
	for (int k = 0; k < vectors; k++)
		sweep_subtract((real *)sweep->field, place + k * LANES, tile.rows[k]);
}

// The forward sweep of one supernode.
INLINE void sweep_forward_node(const cau_sweep *sweep, const cau_supernode *node, bool narrow)
{
	const real *scale = (const real *)sweep->scale + node->first;
	const real *own = (const real *)sweep->field + 4 * (int64_t)node->first;
	real b[4 * CAU_NODE_COLUMNS] __attribute__((aligned(64)));
	for (int32_t j = 0; j < node->columns; j++)
		for (int c = 0; c < 4; c++)
			b[4 * j + c] = scale[j] * own[4 * (int64_t)j + c];
	for (int32_t row = 0; row < node->padded_rows; row += SWEEP_TILE)
		forward_tile(sweep, node, narrow, row, least(SWEEP_TILE, node->padded_rows - row) / LANES,
		             b);
}

// Subtracts from columns [column, column + count) their part of W'^T [D^-1 y; x], for vectors
// [first, last) of rows. `panel` is at the first column and the tile's first row.
INLINE void backward_columns(sweep_panel panel, const sweep_tile *tile, int first, int last,
                             const real *scale, real *column, int count)
{
	v3 sum[SWEEP_BLOCK];
	sweep_prefetch(panel, -SWEEP_AHEAD, count);
	for (int j = 0; j < count; j++)
		sum[j] = v3_zero();
	for (int k = first; k < last; k++)
		for (int j = 0; j < count; j++)
			sum[j] = v3_add_scaled(sum[j], panel_load(panel, j * panel.stride + k * LANES),
			                       tile->rows[k]);
	for (int j = 0; j < count; j++)
		v3_subtract_total(column + 4 * j, scale[j], sum[j]);
}

// Subtracts from all columns the part of rows [row, row + vectors x LANES). Columns are processed
// from the last to the first, as the supernodes are, so that the panels are read in descending
// order.
INLINE void backward_tile(const cau_sweep *sweep, const cau_supernode *node, bool narrow,
                          int32_t row, int vectors, real *own)
{
	const int32_t *place = sweep->backward_place + node->place + row;
	sweep_panel panel = panel_of(sweep, node, row, narrow);
	const real *scale = (const real *)sweep->scale + node->first;
	sweep_tile tile;
	for (int k = 0; k < vectors; k++)
		tile.rows[k] = v3_gather_wide((const real *)sweep->field, place + k * LANES);
	int32_t j = node->columns;
	while (j % SWEEP_BLOCK) {
		--j;
		backward_columns(panel_from(panel, j * panel.stride), &tile, sweep_first(row, j), vectors,
		                 scale + j, own + 4 * j, 1);
	}
	while (j) {
		j -= SWEEP_BLOCK;
		backward_columns(panel_from(panel, j * panel.stride), &tile, sweep_first(row, j), vectors,
		                 scale + j, own + 4 * j, SWEEP_BLOCK);
	}
}

// The backward sweep of one supernode. Its columns hold y on entry and x on return. All its columns
// are rows of the first tile, which is read before any column is written.
INLINE void sweep_backward_node(const cau_sweep *sweep, const cau_supernode *node, bool narrow)
{
	const real *d = (const real *)sweep->d_inverse + node->first;
	real *own = (real *)sweep->field + 4 * (int64_t)node->first;
	for (int32_t i = 0; i < node->columns; i++)
		for (int c = 0; c < 4; c++)
			own[4 * (int64_t)i + c] *= d[i];
	for (int32_t row = 0; row < node->padded_rows; row += SWEEP_TILE)
		backward_tile(sweep, node, narrow, row, least(SWEEP_TILE, node->padded_rows - row) / LANES,
		              own);
}
