// SPDX-License-Identifier: GPL-3.0-or-later
#include "quota/quota.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static cau_config wide(void)
{
	cau_config config;
	cau_config_default(&config);
	config.quota_connection = config.quota_address = config.quota_all = 1000;
	config.quota_view = config.quota_operate = config.quota_admin = 1000;
	return config;
}

// Returns how many of `wanted` requests at the same time are accepted.
static int take(cau_quota *quota, cau_allowance *connection, const char *address, cau_role role,
                double now_s, int wanted, cau_error *error)
{
	int passed = 0;
	while (passed < wanted && !cau_quota_take(quota, connection, NULL, address, role, now_s, error))
		passed++;
	return passed;
}

static void a_connection_has_its_minute(void **state)
{
	(void)state;
	cau_config config = wide();
	config.quota_connection = 6; // six requests a minute are one every ten seconds
	cau_quota *quota = cau_quota_create(&config);
	cau_allowance one = {0}, other = {0};
	cau_error error = {0};
	assert_int_equal(take(quota, &one, "a", CAU_ROLE_VIEW, 100, 20, &error), 6);
	assert_int_equal(error.status, CAU_LIMIT);
	assert_non_null(strstr(error.reason, "setting quota_connection"));
	assert_non_null(strstr(error.reason, "try again in 10."));
	assert_int_equal(take(quota, &other, "a", CAU_ROLE_VIEW, 100, 1, NULL), 1);
	assert_int_equal(take(quota, &one, "a", CAU_ROLE_VIEW, 109, 1, NULL), 0);
	assert_int_equal(take(quota, &one, "a", CAU_ROLE_VIEW, 110.01, 2, NULL), 1);
	assert_int_equal(take(quota, &one, "a", CAU_ROLE_VIEW, 300, 20, NULL), 6);
	cau_quota_destroy(quota);
}

static void connections_of_an_address_share_one(void **state)
{
	(void)state;
	cau_config config = wide();
	config.quota_address = 10;
	cau_quota *quota = cau_quota_create(&config);
	cau_allowance one = {0}, other = {0}, elsewhere = {0};
	cau_error error = {0};
	assert_int_equal(take(quota, &one, "10.0.0.1", CAU_ROLE_VIEW, 5, 7, NULL), 7);
	assert_int_equal(take(quota, &other, "10.0.0.1", CAU_ROLE_ADMIN, 5, 7, &error), 3);
	assert_non_null(strstr(error.reason, "setting quota_address"));
	assert_int_equal(take(quota, &elsewhere, "10.0.0.2", CAU_ROLE_VIEW, 5, 7, NULL), 7);
	cau_quota_destroy(quota);
}

static void roles_do_not_use_up_each_others(void **state)
{
	(void)state;
	cau_config config = wide();
	config.quota_view = 3;
	cau_quota *quota = cau_quota_create(&config);
	cau_allowance viewer = {0}, other = {0}, operators = {0};
	cau_error error = {0};
	assert_int_equal(take(quota, &viewer, "a", CAU_ROLE_VIEW, 1, 2, NULL), 2);
	assert_int_equal(take(quota, &other, "b", CAU_ROLE_VIEW, 1, 5, &error), 1);
	assert_non_null(strstr(error.reason, "setting quota_view"));
	assert_int_equal(take(quota, &operators, "a", CAU_ROLE_OPERATE, 1, 5, NULL), 5);
	cau_quota_destroy(quota);
}

// A request that one allowance refuses takes nothing from the others.
static void a_refusal_takes_nothing(void **state)
{
	(void)state;
	cau_config config = wide();
	config.quota_all = 10;
	config.quota_connection = 2;
	cau_quota *quota = cau_quota_create(&config);
	cau_allowance one = {0}, other[5] = {{0}};
	assert_int_equal(take(quota, &one, "a", CAU_ROLE_VIEW, 1, 2, NULL), 2);
	for (int i = 0; i < 50; i++)
		assert_int_equal(take(quota, &one, "a", CAU_ROLE_VIEW, 1, 1, NULL), 0);
	int passed = 0;
	for (int i = 0; i < 5; i++)
		passed += take(quota, &other[i], "b", CAU_ROLE_VIEW, 1, 2, NULL);
	assert_int_equal(passed, 8);
	cau_quota_destroy(quota);
}

static void more_addresses_than_are_remembered(void **state)
{
	(void)state;
	cau_config config = wide();
	config.quota_address = 2;
	cau_quota *quota = cau_quota_create(&config);
	char text[16];
	cau_allowance busy = {0};
	assert_int_equal(take(quota, &busy, "busy", CAU_ROLE_VIEW, 1, 5, NULL), 2);
	for (int i = 0; i < 600; i++) {
		cau_allowance connection = {0};
		snprintf(text, sizeof text, "10.0.%d.%d", i / 256, i % 256);
		take(quota, &connection, text, CAU_ROLE_VIEW, 1, 1, NULL);
	}
	// The address that has taken most is remembered: its allowance is still used up.
	assert_int_equal(take(quota, &busy, "busy", CAU_ROLE_VIEW, 1, 1, NULL), 0);
	cau_quota_destroy(quota);
	cau_quota_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_connection_has_its_minute),
		cmocka_unit_test(connections_of_an_address_share_one),
		cmocka_unit_test(roles_do_not_use_up_each_others),
		cmocka_unit_test(a_refusal_takes_nothing),
		cmocka_unit_test(more_addresses_than_are_remembered),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
