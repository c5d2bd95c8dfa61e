// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the byte counts of uploads against a model that counts the bytes again after every step.
#include "rpc/uploads.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { CONNECTIONS = 3, NAMES = 6, STEPS = 20000, CONNECTION_MOST = 400000, ALL_MOST = 900000 };

static cau_config config;
static cau_uploads uploads[CONNECTIONS];
static cau_upload_total total;
static int64_t held[CONNECTIONS][NAMES]; // the model: bytes of each name; 0: none

static int begin_anew(void **state)
{
	(void)state;
	cau_config_default(&config);
	config.max_upload_bytes = 300000;
	config.max_connection_upload_bytes = CONNECTION_MOST;
	config.max_all_upload_bytes = ALL_MOST;
	return 0;
}

static uint64_t random_state = 11;

static int64_t random_below(int64_t most)
{
	random_state = random_state * 6364136223846793005u + 1442695040888963407u;
	return (int64_t)(random_state >> 33) % most;
}

static int64_t charge(int64_t bytes)
{
	return bytes == 0 ? 0 : bytes < CAU_UPLOAD_LEAST_BYTES ? CAU_UPLOAD_LEAST_BYTES : bytes;
}

static int64_t held_by(int c)
{
	int64_t sum = 0;
	for (int n = 0; n < NAMES; n++)
		sum += charge(held[c][n]);
	return sum;
}

static int64_t held_by_all(void)
{
	int64_t sum = 0;
	for (int c = 0; c < CONNECTIONS; c++)
		sum += held_by(c);
	return sum;
}

static void try_one(int c, int n)
{
	cau_error error = {0};
	cau_upload *upload = NULL;
	cau_wire_upload_begin wanted = {.byte_count = 1 + random_below(320000)};
	snprintf(wanted.name, sizeof wanted.name, "n%d", n);
	int64_t more = charge(wanted.byte_count) - charge(held[c][n]);
	const char *setting = wanted.byte_count > 300000            ? "max_upload_bytes"
	                      : held_by(c) + more > CONNECTION_MOST ? "max_connection_upload_bytes"
	                      : held_by_all() + more > ALL_MOST     ? "max_all_upload_bytes"
	                                                            : NULL;
	cau_status status = cau_uploads_begin(&uploads[c], &total, &config, &wanted, &upload, &error);
	assert_int_equal(status, setting ? CAU_LIMIT : CAU_OK);
	if (setting) {
		assert_non_null(strstr(error.reason, setting));
		return;
	}
	held[c][n] = wanted.byte_count;
	assert_ptr_equal(cau_uploads_find(&uploads[c], wanted.name), upload);
	assert_ptr_equal(cau_uploads_find_transfer(&uploads[c], upload->transfer), upload);
}

static void drop_one(int c, int n)
{
	char name[8];
	snprintf(name, sizeof name, "n%d", n);
	cau_upload *upload = cau_uploads_find(&uploads[c], name);
	assert_int_equal(upload != NULL, held[c][n] != 0);
	if (upload)
		cau_uploads_drop(&uploads[c], &total, upload);
	held[c][n] = 0;
}

static void the_books_are_true_whatever_comes(void **state)
{
	(void)state;
	for (int i = 0; i < STEPS; i++) {
		int c = (int)random_below(CONNECTIONS), n = (int)random_below(NAMES);
		int64_t what = random_below(20);
		if (what == 0) {
			cau_uploads_drop_all(&uploads[c], &total);
			memset(held[c], 0, sizeof held[c]);
		} else if (what < 8) {
			drop_one(c, n);
		} else {
			try_one(c, n);
		}
		assert_int_equal(uploads[c].bytes, held_by(c));
		assert_int_equal(total.bytes, held_by_all());
	}
	for (int c = 0; c < CONNECTIONS; c++)
		cau_uploads_drop_all(&uploads[c], &total);
	assert_int_equal(total.bytes, 0);
}

static cau_upload *begun(int64_t bytes)
{
	cau_upload *upload = NULL;
	cau_wire_upload_begin wanted = {.name = "knee", .byte_count = bytes};
	assert_int_equal(cau_uploads_begin(&uploads[0], &total, &config, &wanted, &upload, NULL),
	                 CAU_OK);
	return upload;
}

static void a_whole_upload_changes_no_more(void **state)
{
	(void)state;
	static const char abc[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
	cau_upload *upload = begun(3);
	cau_upload_take(upload, 0, "ab", 2);
	assert_int_equal(cau_upload_check(upload, abc, NULL), CAU_BAD_VALUE);
	cau_upload_take(upload, 2, "c", 1);
	assert_int_equal(cau_upload_check(upload, abc, NULL), CAU_OK);
	upload->complete = true;
	cau_upload_take(upload, 0, "x", 1);
	assert_int_equal(cau_upload_check(upload, abc, NULL), CAU_OK);
	cau_uploads_drop_all(&uploads[0], &total);
}

static void what_spoils_an_upload_is_told(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_upload *upload = begun(3);
	cau_upload_take(upload, 1, "b", 1);
	assert_int_equal(cau_upload_check(upload, "", &error), CAU_BAD_VALUE);
	assert_non_null(strstr(error.reason, "out of order"));
	upload = begun(3);
	cau_upload_take(upload, 0, "abcd", 4);
	cau_upload_take(upload, 0, "abc", 3);
	assert_int_equal(cau_upload_check(upload, "", &error), CAU_BAD_VALUE);
	assert_non_null(strstr(error.reason, "more bytes"));
	cau_uploads_drop_all(&uploads[0], &total);
	assert_int_equal(total.bytes, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_books_are_true_whatever_comes),
		cmocka_unit_test(a_whole_upload_changes_no_more),
		cmocka_unit_test(what_spoils_an_upload_is_told),
	};
	return cmocka_run_group_tests(tests, begin_anew, NULL);
}
