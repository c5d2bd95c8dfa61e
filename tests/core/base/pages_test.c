// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

static void test_pages_are_zeroed_and_counted(void **state)
{
	(void)state;
	static const size_t sizes[] = {1, 4096, 100001};
	cau_pages pages[3];
	size_t before = cau_pages_held(), sum = 0;
	for (size_t k = 0; k < 3; k++) {
		assert_true(cau_pages_take(&pages[k], sizes[k]));
		assert_int_equal((uintptr_t)pages[k].start % 4096, 0);
		const unsigned char *byte = pages[k].start;
		for (size_t i = 0; i < sizes[k]; i++)
			assert_int_equal(byte[i], 0);
		memset(pages[k].start, 0xa5, sizes[k]);
		sum += sizes[k];
		assert_int_equal(cau_pages_held(), before + sum);
	}
	for (size_t k = 0; k < 3; k++)
		cau_pages_give_back(&pages[k]);
	assert_int_equal(cau_pages_held(), before);
	assert_null(pages[0].start);
	cau_pages_give_back(&pages[0]); // the pages are empty now
	assert_int_equal(cau_pages_held(), before);
}

static void test_too_much_is_refused(void **state)
{
	(void)state;
	cau_pages pages = {&pages, 1};
	assert_false(cau_pages_take(&pages, SIZE_MAX / 2));
	assert_null(pages.start);
	cau_pages_give_back(&pages);
}

// Pages that were written are reported as touched. cau_pages_touched itself touches no page.
static void test_touched_pages_are_known(void **state)
{
	(void)state;
	enum { COUNT = 1500 }; // more pages than one read of cau_pages_touched reports
	static uint8_t touched[COUNT];
	size_t page = (size_t)sysconf(_SC_PAGESIZE);
	cau_pages pages;
	assert_true(cau_pages_take(&pages, COUNT * page + 1)); // the allocation ends within a page
	for (int round = 0; round < 2; round++) {
		cau_pages_touched(&pages, touched);
		for (int k = 0; k < COUNT; k++)
			assert_int_equal(touched[k], 0);
	}
	memset(pages.start, 1, COUNT * page);
	assert_int_equal(madvise((char *)pages.start + 700 * page, 500 * page, MADV_DONTNEED), 0);
	cau_pages_touched(&pages, touched);
	for (int k = 0; k < COUNT; k++)
		assert_int_equal(touched[k], k < 700 || k >= 1200);
	cau_pages_give_back(&pages);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_pages_are_zeroed_and_counted),
		cmocka_unit_test(test_touched_pages_are_known),
		cmocka_unit_test(test_too_much_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
