// SPDX-License-Identifier: GPL-3.0-or-later
// Sorting of edges and faces by their vertices.
#pragma once

#include <stdbool.h>
#include <stdint.h>

// Sorts the tuples of `tuple` (count x width), whose entries are in [0, bound). Fills order (count)
// with their indices in lexicographic order. Equal tuples keep their order. Uses counting passes:
// O(width (count + bound)). Returns false if memory ran out.
bool cau_index_sort(const int32_t *tuple, int width, int32_t count, int32_t bound, int32_t *order);

// Sorts the entries of a small list in ascending order.
static inline void cau_index_order_row(int32_t *row, int width)
{
	for (int i = 1; i < width; i++)
		for (int j = i; j > 0 && row[j] < row[j - 1]; j--) {
			int32_t larger = row[j - 1];
			row[j - 1] = row[j];
			row[j] = larger;
		}
}
