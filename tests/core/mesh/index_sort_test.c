// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_fixture.h"

#include "mesh/edge_table.h"

enum { ROWS = 2000, WIDTH = 3, BOUND = 11 }; // with a small BOUND many tuples are equal

static void rows_come_in_order_and_equal_ones_in_their_own(void **state)
{
	(void)state;
	int32_t tuple[ROWS * WIDTH], order[ROWS], seen[ROWS] = {0};
	uint32_t random = 1;
	for (int i = 0; i < ROWS * WIDTH; i++) {
		random = random * 1664525u + 1013904223u;
		tuple[i] = (int32_t)((random >> 16) % BOUND);
	}
	assert_true(cau_index_sort(tuple, WIDTH, ROWS, BOUND, order));
	for (int i = 0; i < ROWS; i++) {
		assert_in_range(order[i], 0, ROWS - 1);
		seen[order[i]]++;
	}
	for (int i = 0; i < ROWS; i++)
		assert_int_equal(seen[i], 1);
	for (int i = 1; i < ROWS; i++) {
		const int32_t *a = tuple + WIDTH * order[i - 1], *b = tuple + WIDTH * order[i];
		int c = 0;
		while (c < WIDTH && a[c] == b[c])
			c++;
		assert_true(c == WIDTH ? order[i - 1] < order[i] : a[c] < b[c]);
	}
}

static void a_small_row_comes_in_order(void **state)
{
	(void)state;
	int32_t row[4] = {7, -1, 7, 3};
	cau_index_order_row(row, 4);
	assert_memory_equal(row, ((int32_t[]){-1, 3, 7, 7}), sizeof row);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_come_in_order_and_equal_ones_in_their_own),
		cmocka_unit_test(a_small_row_comes_in_order),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
