// SPDX-License-Identifier: GPL-3.0-or-later
// Small pieces come from malloc, large ones are whole pages. Reallocation keeps the content.
#include "base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const size_t sizes[] = {0, 1, 40, 65535, 65536, 100000, 3000000};
enum { SIZES = 7, FIRST_LARGE = 4 };

static void pieces_are_aligned_and_the_large_ones_pages(void **state)
{
	(void)state;
	size_t before = cau_pages_held();
	for (int k = 0; k < SIZES; k++) {
		unsigned char *piece = cau_large_calloc(sizes[k], 1);
		assert_non_null(piece);
		assert_int_equal((uintptr_t)piece % 16, 0);
		for (size_t i = 0; i < sizes[k]; i++)
			assert_int_equal(piece[i], 0);
		memset(piece, k, sizes[k]);
		cau_pages pages = cau_large_pages(piece);
		assert_int_equal(pages.start != NULL, k >= FIRST_LARGE);
		if (pages.start) {
			assert_true((unsigned char *)pages.start < piece);
			assert_true(pages.byte_count >= sizes[k]);
		}
		cau_large_free(piece);
	}
	assert_int_equal(cau_pages_held(), before);
	cau_large_free(NULL);
	assert_null(cau_large_pages(NULL).start);
}

static void content_moves_along(void **state)
{
	(void)state;
	for (int from = 0; from < SIZES; from++)
		for (int to = 0; to < SIZES; to++) {
			unsigned char *piece = cau_large_malloc(sizes[from]);
			assert_non_null(piece);
			for (size_t i = 0; i < sizes[from]; i++)
				piece[i] = (unsigned char)(7 * i + 1);
			piece = cau_large_realloc(piece, sizes[to]);
			assert_non_null(piece);
			for (size_t i = 0; i < sizes[from] && i < sizes[to]; i++)
				assert_int_equal(piece[i], (unsigned char)(7 * i + 1));
			cau_large_free(piece);
		}
	void *first = cau_large_realloc(NULL, 10);
	assert_non_null(first);
	cau_large_free(first);
}

static void what_is_too_much_is_refused_and_kept(void **state)
{
	(void)state;
	char *piece = cau_large_malloc(10);
	strcpy(piece, "still");
	assert_null(cau_large_malloc(SIZE_MAX));
	assert_null(cau_large_calloc(SIZE_MAX / 4, 8));
	assert_null(cau_large_realloc(piece, SIZE_MAX / 2));
	assert_string_equal(piece, "still");
	cau_large_free(piece);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pieces_are_aligned_and_the_large_ones_pages),
		cmocka_unit_test(content_moves_along),
		cmocka_unit_test(what_is_too_much_is_refused_and_kept),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
