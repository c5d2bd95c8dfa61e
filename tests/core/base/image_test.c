// SPDX-License-Identifier: GPL-3.0-or-later
// Equal pages of several owners share memory. No owner sees another owner's writes, and nothing is
// left afterwards.
#include "base/memory.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "core/base/images_here.h"

enum { PAGES = 64, KEY = 7, LEAST_RUN_BYTES = 16 << 10 };

static size_t page; // page size, bytes

// Fills each page with a pattern from its number and the index of each byte.
static cau_pages patterned(void)
{
	cau_pages pages;
	assert_true(cau_pages_take(&pages, (size_t)PAGES * page));
	unsigned char *byte = pages.start;
	for (size_t i = 0; i < pages.byte_count; i++)
		byte[i] = (unsigned char)(i / page + 3 * i);
	return pages;
}

static bool is_patterned(const cau_pages *pages, size_t but_for_page)
{
	const unsigned char *byte = pages->start;
	for (size_t i = 0; i < pages->byte_count; i++)
		if (i / page != but_for_page && byte[i] != (unsigned char)(i / page + 3 * i))
			return false;
	return true;
}

// Counts the private mappings of images with these rights in this process. Sets *one to the address
// of one mapping.
static int mappings(const char *rights, void **one)
{
	char line[512], found[5];
	int count = 0;
	FILE *file = fopen("/proc/self/maps", "r");
	assert_non_null(file);
	while (fgets(line, sizeof line, file)) {
		void *start;
		if (!strstr(line, "memfd:cautery-image") ||
		    sscanf(line, "%p-%*x %4s", &start, found) != 2 || strcmp(found, rights))
			continue;
		count++;
		if (one)
			*one = start;
	}
	fclose(file);
	return count;
}

static void equal_pages_become_one_until_one_is_written(void **state)
{
	(void)state;
	cau_pages a = patterned(), b = patterned(), c = patterned();
	((char *)b.start)[20 * page + 5]++; // change a page before it is shared
	cau_image *image = cau_image_of(KEY, &a, 1, NULL);
	assert_non_null(image);
	assert_int_equal(cau_image_show(image, &a, 1, false), (size_t)PAGES * page);
	assert_ptr_equal(cau_image_of(KEY, &b, 1, NULL), image);
	assert_int_equal(cau_image_show(image, &b, 1, false), (size_t)(PAGES - 1) * page);
	// the image has one mapping in a, and two in b, around the changed page
	assert_int_equal(mappings("rw-p", NULL), 3);
	assert_true(is_patterned(&a, PAGES));
	assert_true(is_patterned(&b, 20));
	((char *)a.start)[30 * page]++; // change a page of each afterwards
	((char *)b.start)[40 * page]++;
	assert_false(is_patterned(&a, PAGES));
	assert_true(is_patterned(&a, 30));
	assert_false(is_patterned(&b, 20));
	// the image is unchanged, so the call returns it
	assert_ptr_equal(cau_image_of(KEY, &c, 1, NULL), image);
	assert_int_equal(cau_image_show(image, &c, 1, false), (size_t)PAGES * page);
	for (int i = 0; i < 3; i++)
		cau_image_release(image);
	assert_int_equal(cau_image_count(), 0);
	assert_true(is_patterned(&c, PAGES)); // the mapping still exists without the image
	cau_pages_give_back(&a);
	cau_pages_give_back(&b);
	cau_pages_give_back(&c);
	assert_int_equal(mappings("rw-p", NULL), 0);
}

// The first session's pages are mapped without a comparison. The pages of further sessions are
// compared.
static void who_made_it_knows(void **state)
{
	(void)state;
	cau_pages a = patterned(), b = patterned();
	bool made = false;
	cau_image *image = cau_image_of(KEY, &a, 1, &made);
	assert_non_null(image);
	assert_true(made);
	assert_int_equal(cau_image_show(image, &a, 1, made), (size_t)PAGES * page);
	assert_int_equal(mappings("rw-p", NULL), 1);
	assert_true(is_patterned(&a, PAGES));
	((char *)b.start)[20 * page]++;
	assert_ptr_equal(cau_image_of(KEY, &b, 1, &made), image);
	assert_false(made);
	assert_int_equal(cau_image_show(image, &b, 1, made), (size_t)(PAGES - 1) * page);
	assert_true(is_patterned(&b, 20));
	assert_false(is_patterned(&b, PAGES)); // b has its own page, not the image's
	((char *)b.start)[20 * page]--;
	assert_true(is_patterned(&b, PAGES));
	cau_image_release(image);
	cau_image_release(image);
	cau_pages_give_back(&a);
	cau_pages_give_back(&b);
}

static void nothing_can_write_an_image(void **state)
{
	(void)state;
	void *view = NULL;
	cau_pages a = patterned();
	cau_image *image = cau_image_of(KEY, &a, 1, NULL);
	assert_non_null(image);
	assert_int_equal(mappings("r--s", &view), 1);
	assert_int_equal(mprotect(view, page, PROT_READ | PROT_WRITE), -1);
	assert_true(errno == EACCES || errno == EPERM);
	cau_image_release(image);
	assert_int_equal(mappings("r--s", NULL), 0);
	cau_pages_give_back(&a);
}

// Runs shorter than 16 KiB, parts of another size, and parts at another position are not replaced
// by pages of the image.
static void short_runs_and_others_stay_as_they_are(void **state)
{
	(void)state;
	cau_pages a[2] = {patterned(), patterned()}, b[2] = {patterned(), patterned()};
	size_t run = LEAST_RUN_BYTES / page;
	for (size_t k = run - 1; k < PAGES; k += run)
		((char *)b[1].start)[k * page]++;
	cau_pages half = {a[0].start, a[0].byte_count / 2};
	cau_image *image = cau_image_of(KEY, a, 2, NULL);
	assert_non_null(image);
	assert_int_equal(cau_image_show(image, &half, 1, false), 0);
	assert_int_equal(cau_image_show(image, b, 2, false), (size_t)PAGES * page);
	assert_int_equal(cau_image_show(image, b, 0, false), 0);
	cau_image_release(image);
	for (int i = 0; i < 2; i++) {
		cau_pages_give_back(&a[i]);
		cau_pages_give_back(&b[i]);
	}
}

static int touched_of(const cau_pages *pages)
{
	uint8_t touched[PAGES];
	int count = 0;
	cau_pages_touched(pages, touched);
	for (int k = 0; k < PAGES; k++)
		count += touched[k];
	return count;
}

// The middle of `a` was never touched. The first and the last quarter were, although the first
// contains zeros.
static void untouched_pages_are_in_no_image(void **state)
{
	(void)state;
	enum { QUARTER = PAGES / 4 };
	cau_pages a[2];
	cau_image *image = NULL;
	for (int i = 0; i < 2; i++) {
		assert_true(cau_pages_take(&a[i], (size_t)PAGES * page));
		char *byte = a[i].start;
		memset(byte, 0, QUARTER * page);
		memset(byte + 3 * QUARTER * page, 5, QUARTER * page);
		image = cau_image_of(KEY, &a[i], 1, NULL);
		assert_non_null(image);
		assert_int_equal(cau_image_show(image, &a[i], 1, i == 0), (size_t)2 * QUARTER * page);
		// cau_image_show neither reads nor copies these pages
		assert_int_equal(touched_of(&a[i]), 0);
		assert_int_equal(mappings("rw-p", NULL), 2 * (i + 1));
		for (int k = 0; k < PAGES; k++)
			assert_int_equal(byte[(size_t)k * page + 7], k < 3 * QUARTER ? 0 : 5);
	}
	for (int i = 0; i < 2; i++) {
		cau_image_release(image);
		cau_pages_give_back(&a[i]);
	}
}

// A page that is zero in one session only, or in the image only, is not shared.
static void zeros_of_one_are_not_shown_to_another(void **state)
{
	(void)state;
	cau_pages a = patterned(), b = patterned(), c = patterned();
	memset((char *)a.start + 8 * page, 0, page);
	memset((char *)b.start + 20 * page, 0, page);
	cau_image *image = cau_image_of(KEY, &a, 1, NULL);
	assert_non_null(image);
	assert_int_equal(cau_image_show(image, &b, 1, false), (size_t)(PAGES - 2) * page);
	assert_true(is_patterned(&b, 20));
	assert_int_equal(((char *)b.start)[20 * page + 1], 0);
	assert_int_equal(cau_image_show(image, &c, 1, false), (size_t)(PAGES - 1) * page);
	assert_true(is_patterned(&c, PAGES));
	cau_image_release(image);
	cau_pages_give_back(&a);
	cau_pages_give_back(&b);
	cau_pages_give_back(&c);
}

// The system's list of touched pages cannot be opened, because no file can. So all pages count as
// touched.
static void without_the_systems_word_all_are_read(void **state)
{
	(void)state;
	struct rlimit before, none;
	cau_pages a = patterned(), b = patterned();
	memset((char *)a.start + (size_t)PAGES / 2 * page, 0, (size_t)PAGES / 2 * page);
	cau_pages_give_back(&b);
	assert_true(cau_pages_take(&b, (size_t)PAGES * page));
	memcpy(b.start, a.start, (size_t)PAGES / 2 * page);
	assert_true(touched_of(&b) < PAGES);
	cau_image *image = cau_image_of(KEY, &a, 1, NULL);
	assert_non_null(image);
	assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
	none = (struct rlimit){0, before.rlim_max};
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
	int touched = touched_of(&b);
	size_t shown = cau_image_show(image, &b, 1, false);
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
	assert_int_equal(touched, PAGES);
	assert_int_equal(shown, (size_t)PAGES * page);
	assert_memory_equal(a.start, b.start, (size_t)PAGES * page);
	cau_image_release(image);
	cau_pages_give_back(&a);
	cau_pages_give_back(&b);
}

static void each_key_has_its_own(void **state)
{
	(void)state;
	cau_pages a = patterned();
	cau_image *image[2] = {cau_image_of(1, &a, 1, NULL), cau_image_of(2, &a, 1, NULL)};
	assert_non_null(image[0]);
	assert_ptr_not_equal(image[0], image[1]);
	assert_int_equal(cau_image_count(), 2);
	cau_image_release(image[0]); // the older image is second in the list
	assert_int_equal(cau_image_count(), 1);
	assert_ptr_equal(cau_image_of(2, &a, 1, NULL), image[1]);
	cau_image_release(image[1]);
	cau_image_release(image[1]);
	cau_image_release(NULL);
	assert_int_equal(cau_image_count(), 0);
	cau_pages_give_back(&a);
}

static void of_too_much_and_of_nothing_there_is_none(void **state)
{
	(void)state;
	cau_pages much, blank, nothing = {0};
	assert_true(cau_pages_take(&much, CAU_IMAGE_BYTES + page)); // the pages were never touched
	assert_null(cau_image_of(KEY, &much, 1, NULL));
	*(char *)much.start = 1;
	assert_null(cau_image_of(KEY, &much, 1, NULL));
	assert_true(cau_pages_take(&blank, (size_t)PAGES * page));
	assert_null(cau_image_of(KEY, &blank, 1, NULL));
	assert_int_equal(touched_of(&blank), 0); // cau_image_of has not touched any page
	cau_pages_give_back(&blank);
	assert_null(cau_image_of(KEY, &nothing, 1, NULL));
	assert_null(cau_image_of(KEY, NULL, 0, NULL));
	assert_int_equal(cau_image_count(), 0);
	cau_pages_give_back(&much);
}

int main(void)
{
	page = (size_t)sysconf(_SC_PAGESIZE);
	if (!images_here()) {
		print_message("skipped: this system has no sealed files in memory\n");
		return 77;
	}
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(equal_pages_become_one_until_one_is_written),
		cmocka_unit_test(who_made_it_knows),
		cmocka_unit_test(nothing_can_write_an_image),
		cmocka_unit_test(short_runs_and_others_stay_as_they_are),
		cmocka_unit_test(untouched_pages_are_in_no_image),
		cmocka_unit_test(zeros_of_one_are_not_shown_to_another),
		cmocka_unit_test(without_the_systems_word_all_are_read),
		cmocka_unit_test(each_key_has_its_own),
		cmocka_unit_test(of_too_much_and_of_nothing_there_is_none),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
