// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/internal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void messages_leave_in_order_and_whole(void **state)
{
	(void)state;
	cau_outbox outbox = {0};
	assert_int_equal(cau_outbox_add(&outbox, false, "ab", 2, "c", 1, NULL), CAU_OK);
	assert_int_equal(cau_outbox_add(&outbox, true, "d", 1, NULL, 0, NULL), CAU_OK);
	assert_int_equal(outbox.byte_count, 4);
	cau_outbox_message *first = cau_outbox_take(&outbox), *second = cau_outbox_take(&outbox);
	assert_int_equal(first->byte_count, 3);
	assert_memory_equal(cau_outbox_bytes(first), "abc", 3);
	assert_false(first->binary);
	assert_memory_equal(cau_outbox_bytes(second), "d", 1);
	assert_true(second->binary);
	assert_null(cau_outbox_take(&outbox));
	assert_int_equal(outbox.byte_count, 0);
	free(first);
	free(second);
}

static void what_exceeds_the_bound_is_refused_and_room_comes_back(void **state)
{
	(void)state;
	cau_outbox outbox = {0};
	cau_error error = {0};
	char *much = calloc(1, CAU_OUTBOX_BYTES_MAX);
	assert_int_equal(cau_outbox_add(&outbox, true, much, CAU_OUTBOX_BYTES_MAX, NULL, 0, NULL),
	                 CAU_OK);
	assert_int_equal(cau_outbox_add(&outbox, false, "a", 1, NULL, 0, &error), CAU_LIMIT);
	free(cau_outbox_take(&outbox));
	assert_int_equal(cau_outbox_add(&outbox, false, "a", 1, NULL, 0, NULL), CAU_OK);
	cau_outbox_clear(&outbox);
	assert_null(outbox.first);
	assert_int_equal(outbox.byte_count, 0);
	free(much);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(messages_leave_in_order_and_whole),
		cmocka_unit_test(what_exceeds_the_bound_is_refused_and_room_comes_back),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
