// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that cells are found by position and joined with their neighbours, whatever the order of
// addition. A severed cell has no neighbours.
#include "bioheat/cells.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bar.h"

enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE };

// Makes a cube of cells around the origin. Cells are added in a mixed order (95 and 216 have no
// common divisor).
static cau_cells cube(cau_arena *arena)
{
	cau_cells cells;
	assert_int_equal(cau_cells_create(&cells, 1e-4, COUNT, arena, NULL), CAU_OK);
	for (int k = 0; k < COUNT; k++) {
		int at = k * 95 % COUNT;
		int32_t place[] = {at % SIDE - 3, at / SIDE % SIDE - 3, at / SIDE / SIDE - 3};
		assert_int_equal(cau_cells_find(&cells, place), -1);
		assert_int_equal(cau_cells_add(&cells, place, 0, 1), k);
	}
	return cells;
}

static int32_t beyond(const cau_cells *cells, int32_t cell, int side)
{
	int32_t place[3];
	for (int axis = 0; axis < 3; axis++)
		place[axis] = cells->place[3 * cell + axis] + (axis == side / 2 ? (side % 2 ? 1 : -1) : 0);
	return cau_cells_find(cells, place);
}

static void neighbours_are_those_beside(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_cells cells = cube(&arena);
	for (int32_t cell = 0; cell < COUNT; cell++)
		for (int side = 0; side < CAU_CELL_SIDES; side++)
			assert_int_equal(cells.neighbour[CAU_CELL_SIDES * cell + side],
			                 beyond(&cells, cell, side));
	// The capacity is used up.
	assert_int_equal(cau_cells_add(&cells, (int32_t[]){50, 0, 0}, 0, 1), -1);
	cau_arena_finish(&arena);
}

// Copies into a set of other cells, some at the same positions. The former cells are no longer
// found.
static void a_copy_has_the_same_cells_and_no_others(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_cells from = cube(&arena), to;
	assert_int_equal(cau_cells_create(&to, 1e-4, COUNT, &arena, NULL), CAU_OK);
	for (int k = 0; k < COUNT / 2; k++)
		cau_cells_add(&to, (int32_t[]){k % 18 - 9, k / 18 - 3, 0}, 0, 0.5F);
	cau_cells_sever(&from, 7);
	cau_cells_copy(&to, &from);
	assert_int_equal(to.count, COUNT);
	for (int32_t x = -9; x < 9; x++)
		for (int32_t y = -3; y < 3; y++)
			for (int32_t z = -3; z < 3; z++) {
				const int32_t place[] = {x, y, z};
				assert_int_equal(cau_cells_find(&to, place), cau_cells_find(&from, place));
			}
	// A later cell gets the same bucket in both sets.
	assert_memory_equal(to.bucket, from.bucket, (size_t)to.bucket_count * sizeof *to.bucket);
	assert_memory_equal(to.neighbour, from.neighbour,
	                    (size_t)COUNT * CAU_CELL_SIDES * sizeof *to.neighbour);
	assert_memory_equal(to.severed, from.severed, COUNT);
	cau_arena_finish(&arena);
}

static void a_severed_cell_has_no_neighbours(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_cells cells = cube(&arena);
	int32_t cell = cau_cells_find(&cells, (int32_t[]){0, 0, 0});
	cau_cells_sever(&cells, cell);
	for (int side = 0; side < CAU_CELL_SIDES; side++) {
		int32_t other = beyond(&cells, cell, side);
		assert_int_equal(cells.neighbour[CAU_CELL_SIDES * cell + side], -1);
		assert_int_equal(cells.neighbour[CAU_CELL_SIDES * other + (side ^ 1)], -1);
	}
	cau_arena_finish(&arena);
}

static void a_face_conducts_by_the_emptier_cell(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_cells cells;
	assert_int_equal(cau_cells_create(&cells, 2e-4, 2, &arena, NULL), CAU_OK);
	cau_cells_add(&cells, (int32_t[]){0, 0, 0}, 0, 1);
	cau_cells_add(&cells, (int32_t[]){1, 0, 0}, 0, 0.25f);
	assert_near(cau_cells_face(&cells, 0, 1), 0.25 * 2e-4, 1e-12);
	assert_near(cau_cells_volume(&cells, 1), 0.25 * 8e-12, 1e-20);
	cau_arena_finish(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(neighbours_are_those_beside),
		cmocka_unit_test(a_copy_has_the_same_cells_and_no_others),
		cmocka_unit_test(a_severed_cell_has_no_neighbours),
		cmocka_unit_test(a_face_conducts_by_the_emptier_cell),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
