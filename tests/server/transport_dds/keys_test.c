// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/checks.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

enum { MANY = 10000 };

static cau_dds_keys keys;

static int set_up(void **state)
{
	(void)state;
	cau_dds_keys_init(&keys, "d1-knee");
	cau_dds_keys_set_tools(&keys, (const char *const[]){"hook", "grasper"}, 2);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	cau_dds_keys_finish(&keys);
	return 0;
}

// Offers `count` keys that belong to no tool. Returns how many were accepted.
static int admit_strangers(int count)
{
	char name[CAU_NAME_BYTES];
	int admitted = 0;
	for (int i = 0; i < count; i++) {
		snprintf(name, sizeof name, "made-up-%d", i);
		admitted += cau_dds_keys_admit(&keys, i % 2 ? name : "d1-knee", i % 2 ? "hook" : name);
	}
	return admitted;
}

static void a_few_strangers_are_let_in_and_the_rest_is_counted(void **state)
{
	(void)state;
	assert_int_equal(admit_strangers(CAU_DDS_STRANGERS_MOST), CAU_DDS_STRANGERS_MOST);
	assert_int_equal(cau_dds_keys_take_dropped(&keys), 0);
	assert_int_equal(admit_strangers(MANY), CAU_DDS_STRANGERS_MOST); // the same keys as before
	assert_int_equal(cau_dds_keys_take_dropped(&keys), MANY - CAU_DDS_STRANGERS_MOST);
	assert_int_equal(cau_dds_keys_take_dropped(&keys), 0);
}

static void the_tools_of_the_session_are_let_in_however_many_strangers_came(void **state)
{
	(void)state;
	admit_strangers(MANY);
	assert_true(cau_dds_keys_admit(&keys, "d1-knee", "hook"));
	assert_true(cau_dds_keys_admit(&keys, "d1-knee", "grasper"));
	assert_false(cau_dds_keys_admit(&keys, "d1-hip", "grasper"));
	assert_false(cau_dds_keys_admit(&keys, "d1-knee", "shears"));
	cau_dds_keys_set_tools(&keys, (const char *const[]){"shears"}, 1);
	assert_true(cau_dds_keys_admit(&keys, "d1-knee", "shears"));
	assert_false(cau_dds_keys_admit(&keys, "d1-knee", "grasper"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_few_strangers_are_let_in_and_the_rest_is_counted, set_up,
	                                    tear_down),
		cmocka_unit_test_setup_teardown(
			the_tools_of_the_session_are_let_in_however_many_strangers_came, set_up, tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
