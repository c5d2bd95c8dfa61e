// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/cells.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"

// Least number of buckets for each cell, so that a search ends after a few buckets.
enum { BUCKETS_PER_CELL = 2 };

static int32_t bucket_count_for(int32_t capacity)
{
	CAU_ASSERT(capacity > 0 && capacity < INT32_MAX / 8, "%d cells", capacity);
	int32_t count = 1;
	while (count < BUCKETS_PER_CELL * capacity)
		count *= 2;
	return count;
}

cau_status cau_cells_create(cau_cells *cells, double side_m, int32_t capacity, cau_arena *arena,
                            cau_error *error)
{
	CAU_ASSERT(side_m > 0, "cells of %g m", side_m);
	size_t most = (size_t)capacity;
	*cells = (cau_cells){.side_m = side_m, .capacity = capacity};
	cells->bucket_count = bucket_count_for(capacity);
	cells->place = cau_arena_array(arena, 3 * most, sizeof(int32_t));
	cells->neighbour = cau_arena_array(arena, CAU_CELL_SIDES * most, sizeof(int32_t));
	cells->material = cau_arena_array(arena, most, 1);
	cells->fill = cau_arena_array(arena, most, sizeof(float));
	cells->pull = cau_arena_array(arena, 3 * most, sizeof(float));
	cells->severed = cau_arena_array(arena, most, 1);
	cells->bucket = cau_arena_array(arena, (size_t)cells->bucket_count, sizeof(int32_t));
	if (!cells->place || !cells->neighbour || !cells->material || !cells->fill || !cells->pull ||
	    !cells->severed || !cells->bucket)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %d cells of tissue", capacity);
	return CAU_OK;
}

// Returns the bucket of a position. This is the bucket of the cell there, or an empty bucket for a
// new cell. Large odd factors spread neighbours over the buckets.
static int32_t bucket_of(const cau_cells *cells, const int32_t place[3])
{
	uint32_t hash = (uint32_t)place[0] * 73856093u ^ (uint32_t)place[1] * 19349663u ^
	                (uint32_t)place[2] * 83492791u;
	uint32_t mask = (uint32_t)cells->bucket_count - 1;
	for (uint32_t bucket = (hash ^ hash >> 15) & mask;; bucket = (bucket + 1) & mask) {
		int32_t cell = cells->bucket[bucket] - 1;
		if (cell < 0 || memcmp(cells->place + 3 * (size_t)cell, place, 3 * sizeof *place) == 0)
			return (int32_t)bucket;
	}
}

int32_t cau_cells_find(const cau_cells *cells, const int32_t place[3])
{
	return cells->bucket[bucket_of(cells, place)] - 1;
}

static void join(cau_cells *cells, int32_t cell)
{
	for (int side = 0; side < CAU_CELL_SIDES; side++) {
		int32_t place[3];
		memcpy(place, cells->place + 3 * (size_t)cell, sizeof place);
		place[side / 2] += side % 2 ? 1 : -1;
		int32_t other = cau_cells_find(cells, place);
		if (other >= 0 && cells->severed[other])
			other = -1;
		cells->neighbour[cau_cell_side(cell, side)] = other;
		if (other >= 0)
			cells->neighbour[cau_cell_side(other, side ^ 1)] = cell;
	}
}

int32_t cau_cells_add(cau_cells *cells, const int32_t place[3], uint8_t material, float fill)
{
	CAU_ASSERT(fill > 0 && fill <= 1, "a cell of which %g is tissue", (double)fill);
	if (cells->count == cells->capacity)
		return -1;
	int32_t cell = cells->count++, bucket = bucket_of(cells, place);
	CAU_ASSERT(!cells->bucket[bucket], "a second cell at (%d, %d, %d)", place[0], place[1],
	           place[2]);
	cells->bucket[bucket] = cell + 1;
	memcpy(cells->place + 3 * (size_t)cell, place, 3 * sizeof *place);
	cells->material[cell] = material;
	cells->fill[cell] = fill;
	cells->severed[cell] = 0; // a severed cell may have had this index before a restore
	for (int axis = 0; axis < 3; axis++)
		cells->pull[cau_cell_axis(cell, axis)] = 1;
	join(cells, cell);
	return cell;
}

// Empties all buckets, the newest cell's first. The search for a cell's bucket passes only buckets
// of older cells.
static void empty_buckets(cau_cells *cells)
{
	for (int32_t cell = cells->count - 1; cell >= 0; cell--)
		cells->bucket[bucket_of(cells, cells->place + 3 * (size_t)cell)] = 0;
}

void cau_cells_copy(cau_cells *to, const cau_cells *from)
{
	CAU_ASSERT(to->capacity == from->capacity, "%d cells, not %d", to->capacity, from->capacity);
	size_t count = (size_t)from->count;
	empty_buckets(to);
	to->count = from->count;
	memcpy(to->place, from->place, 3 * count * sizeof *to->place);
	memcpy(to->neighbour, from->neighbour, CAU_CELL_SIDES * count * sizeof *to->neighbour);
	memcpy(to->material, from->material, count);
	memcpy(to->fill, from->fill, count * sizeof *to->fill);
	memcpy(to->pull, from->pull, 3 * count * sizeof *to->pull);
	memcpy(to->severed, from->severed, count);
	for (int32_t cell = 0; cell < to->count; cell++)
		to->bucket[bucket_of(to, to->place + 3 * (size_t)cell)] = cell + 1;
}

void cau_cells_sever(cau_cells *cells, int32_t cell)
{
	CAU_ASSERT_INDEX(cell, cells->count);
	cells->severed[cell] = 1;
	for (int side = 0; side < CAU_CELL_SIDES; side++) {
		int32_t *other = &cells->neighbour[cau_cell_side(cell, side)];
		if (*other >= 0)
			cells->neighbour[cau_cell_side(*other, side ^ 1)] = -1;
		*other = -1;
	}
}

double cau_cells_face(const cau_cells *cells, int32_t cell, int side)
{
	CAU_ASSERT_INDEX(cell, cells->count);
	CAU_ASSERT_INDEX(side, CAU_CELL_SIDES);
	int32_t other = cells->neighbour[cau_cell_side(cell, side)];
	CAU_ASSERT_INDEX(other, cells->count);
	double fill = fminf(cells->fill[cell], cells->fill[other]);
	double own = cells->pull[cau_cell_axis(cell, side / 2)];
	double others = cells->pull[cau_cell_axis(other, side / 2)];
	return cells->side_m * fill * (own + others) / 2;
}

double cau_cells_volume(const cau_cells *cells, int32_t cell)
{
	CAU_ASSERT_INDEX(cell, cells->count);
	return cells->fill[cell] * cells->side_m * cells->side_m * cells->side_m;
}
