// SPDX-License-Identifier: GPL-3.0-or-later
#include "buffer/buffer.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <sys/resource.h>

#include <cmocka.h>

enum {
	PAGE_BYTES = 4096,
	PIECE_BYTES = 8000000, // size of a checkpoint of 40,000 vertices
	PIECES = 2,
	ROUNDS = 1000,
};

static long faults(void)
{
	struct rusage usage;
	getrusage(RUSAGE_THREAD, &usage);
	return usage.ru_minflt;
}

// Takes a piece and writes all of it, as a slice does. Returns the number of page faults.
static long faults_of_copying(cau_shelf *shelf, size_t bytes, void **piece)
{
	long before = faults();
	*piece = cau_shelf_take(shelf, bytes);
	assert_non_null(*piece);
	memset(*piece, 0x5a, bytes);
	return faults() - before;
}

static cau_shelf *stocked(size_t bytes, int count)
{
	cau_shelf *shelf = cau_shelf_create();
	assert_non_null(shelf);
	cau_shelf_stock(shelf, bytes, count);
	return shelf;
}

// Largest number of page faults that a test allows. For example, a call may reach a page of the
// stack first.
static const long FEW_FAULTS = 16;

static void test_no_page_is_looked_for_in_a_slice(void **state)
{
	(void)state;
	cau_shelf *shelf = stocked(PIECE_BYTES, PIECES);
	void *piece[PIECES];
	for (int round = 0; round < 3; round++) {
		for (int i = 0; i < PIECES; i++)
			assert_true(faults_of_copying(shelf, PIECE_BYTES, &piece[i]) < FEW_FAULTS);
		for (int i = 0; i < PIECES; i++)
			cau_shelf_give_back(piece[i]);
	}
	cau_shelf_release(shelf);
}

static void test_a_piece_that_grows_keeps_its_pages(void **state)
{
	(void)state;
	size_t larger = PIECE_BYTES + PIECE_BYTES / 2;
	cau_shelf *shelf = stocked(PIECE_BYTES, 1);
	void *piece;
	long most = (long)(larger - PIECE_BYTES) / PAGE_BYTES + FEW_FAULTS;
	assert_true(faults_of_copying(shelf, larger, &piece) <= most);
	cau_shelf_give_back(piece);
	// the piece keeps its larger size
	assert_true(faults_of_copying(shelf, larger, &piece) < FEW_FAULTS);
	cau_shelf_give_back(piece);
	cau_shelf_release(shelf);
}

static void test_more_than_lie_there_are_made(void **state)
{
	(void)state;
	cau_shelf *shelf = stocked(100, 1), *empty = cau_shelf_create();
	void *piece[3] = {cau_shelf_take(shelf, 100), cau_shelf_take(shelf, 100),
	                  cau_shelf_take(empty, 100)};
	for (int i = 0; i < 3; i++) {
		assert_non_null(piece[i]);
		memset(piece[i], i, 100);
	}
	assert_ptr_not_equal(piece[0], piece[1]);
	for (int i = 0; i < 3; i++)
		cau_shelf_give_back(piece[i]); // the second has no place on the shelf and is freed
	cau_shelf_give_back(NULL);
	cau_shelf_release(shelf);
	cau_shelf_release(empty);
	cau_shelf_release(NULL);
}

// A piece is given back after its shelf is released, as when the store commits a checkpoint of a
// session that has ended.
static void test_a_piece_outlives_its_shelf(void **state)
{
	(void)state;
	cau_shelf *shelf = stocked(100, PIECES);
	void *first = cau_shelf_take(shelf, 100), *second = cau_shelf_take(shelf, 100);
	cau_shelf_release(shelf);
	memset(first, 1, 100);
	cau_shelf_give_back(first);
	memset(second, 2, 100);
	cau_shelf_give_back(second);
}

static void *take_and_give(void *user)
{
	for (int i = 0; i < ROUNDS; i++) {
		unsigned char *piece = cau_shelf_take(user, 64);
		memset(piece, i, 64);
		cau_shelf_give_back(piece);
	}
	return NULL;
}

static void test_threads_have_pieces_of_their_own(void **state)
{
	(void)state;
	cau_shelf *shelf = stocked(64, 1);
	pthread_t threads[3];
	for (int i = 0; i < 3; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, take_and_give, shelf), 0);
	for (int i = 0; i < 3; i++)
		pthread_join(threads[i], NULL);
	cau_shelf_release(shelf);
}

int main(void)
{
	// Sanitizers cause page faults of their own, so these tests are skipped under them.
	const struct CMUnitTest pages[] = {
		cmocka_unit_test(test_no_page_is_looked_for_in_a_slice),
		cmocka_unit_test(test_a_piece_that_grows_keeps_its_pages),
	};
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_more_than_lie_there_are_made),
		cmocka_unit_test(test_a_piece_outlives_its_shelf),
		cmocka_unit_test(test_threads_have_pieces_of_their_own),
	};
	int failed = CAU_TEST_SANITIZED ? 0 : cmocka_run_group_tests_name("pages", pages, NULL, NULL);
	return failed + cmocka_run_group_tests(tests, NULL, NULL);
}
