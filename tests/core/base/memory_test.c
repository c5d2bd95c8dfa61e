// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { ALIGNMENT = 64 };

static void test_arrays_are_zeroed_aligned_and_padded(void **state)
{
	(void)state;
	static const size_t counts[] = {0, 1, 7, 63, 64, 65, 1000};
	cau_arena arena = {0};
	unsigned char *array[7];
	for (size_t k = 0; k < 7; k++) {
		array[k] = cau_arena_array(&arena, counts[k], 3);
		assert_non_null(array[k]);
		assert_int_equal((uintptr_t)array[k] % ALIGNMENT, 0);
		for (size_t i = 0; i < 3 * counts[k] + ALIGNMENT; i++)
			assert_int_equal(array[k][i], 0);
		// the padding belongs to the caller too
		memset(array[k], (int)k + 1, 3 * counts[k] + ALIGNMENT);
	}
	for (size_t k = 0; k < 7; k++) // no array overlaps another
		for (size_t i = 0; i < 3 * counts[k] + ALIGNMENT; i++)
			assert_int_equal(array[k][i], k + 1);
	assert_true(arena.byte_count >= 3 * 1200);
	cau_arena_finish(&arena);
	assert_int_equal(arena.byte_count, 0);
	assert_null(arena.blocks);
	cau_arena_finish(&arena);
}

static void test_sizes_that_overflow_are_refused(void **state)
{
	(void)state;
	cau_arena arena = {0};
	assert_null(cau_arena_array(&arena, SIZE_MAX, 2));
	assert_null(cau_arena_array(&arena, SIZE_MAX / 4 + 1, 4));
	assert_null(cau_arena_array(&arena, SIZE_MAX / 16, 16));
	assert_null(cau_arena_array(&arena, SIZE_MAX - 8, 1));
	assert_null(cau_arena_copy(&arena, &arena, SIZE_MAX, 8));
	assert_int_equal(arena.byte_count, 0);
	cau_arena_finish(&arena);
}

static void test_copy(void **state)
{
	(void)state;
	static const int32_t source[5] = {3, 1, 4, 1, 5};
	cau_arena arena = {0};
	int32_t *copy = cau_arena_copy(&arena, source, 5, sizeof *source);
	assert_memory_equal(copy, source, sizeof source);
	assert_int_equal(copy[5], 0);
	assert_non_null(cau_arena_copy(&arena, NULL, 0, 8));
	cau_arena_finish(&arena);
}

// Allocates as a session does: a few large arrays among many small ones.
static void fill(cau_arena *arena, unsigned char *array[40], size_t bytes[40])
{
	for (size_t k = 0; k < 40; k++) {
		bytes[k] = k % 8 == 3 ? 300000 * (k + 1) : 1 + 997 * k;
		array[k] = cau_arena_array(arena, bytes[k], 1);
		assert_non_null(array[k]);
	}
}

static void test_arrays_lie_in_few_blocks_alike_in_each_arena(void **state)
{
	(void)state;
	cau_arena arena[2] = {0};
	unsigned char *array[2][40];
	size_t bytes[40], held = 0;
	cau_pages pages[2][60];
	int32_t count[2];
	for (int i = 0; i < 2; i++) {
		fill(&arena[i], array[i], bytes);
		count[i] = cau_arena_pages(&arena[i], pages[i], 60);
	}
	assert_int_equal(count[0], count[1]);
	assert_in_range(count[0], 2, 20);
	for (int32_t b = 0; b < count[0]; b++) {
		assert_int_equal(pages[0][b].byte_count, pages[1][b].byte_count);
		held += pages[0][b].byte_count;
	}
	assert_true(held < arena[0].byte_count + arena[0].byte_count / 4);
	// each array is in one block, at the same offset in both arenas
	for (size_t k = 0; k < 40; k++) {
		int32_t in = -1;
		for (int32_t b = 0; b < count[0] && in < 0; b++) {
			unsigned char *start = pages[0][b].start;
			if (array[0][k] >= start && array[0][k] + bytes[k] <= start + pages[0][b].byte_count)
				in = b;
		}
		assert_true(in >= 0);
		assert_int_equal(array[0][k] - (unsigned char *)pages[0][in].start,
		                 array[1][k] - (unsigned char *)pages[1][in].start);
	}
	assert_int_equal(cau_arena_pages(&arena[0], pages[0], 1), 1);
	for (int i = 0; i < 2; i++)
		cau_arena_finish(&arena[i]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_arrays_are_zeroed_aligned_and_padded),
		cmocka_unit_test(test_sizes_that_overflow_are_refused),
		cmocka_unit_test(test_copy),
		cmocka_unit_test(test_arrays_lie_in_few_blocks_alike_in_each_arena),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
