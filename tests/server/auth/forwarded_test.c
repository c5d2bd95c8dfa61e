// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that X-Forwarded-For, which anyone may write, is believed only from proxies that the
// setting trusts.
#include "auth/auth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// Checks the address of a connection from `peer` with the header `forwarded`.
static void assert_address(const char *proxies, const char *peer, const char *forwarded,
                           const char *expected)
{
	cau_config config;
	char address[64];
	cau_config_default(&config);
	assert_int_equal(cau_config_set(&config, "trusted_proxies", proxies, NULL), CAU_OK);
	snprintf(address, sizeof address, "%s", peer);
	cau_auth_find_address(&config, forwarded, address, sizeof address);
	assert_string_equal(address, expected);
}

static void who_is_no_proxy_is_who_it_is(void **state)
{
	(void)state;
	assert_address("", "10.0.0.9", "1.2.3.4", "10.0.0.9");
	assert_address("10.0.0.1", "10.0.0.9", "1.2.3.4", "10.0.0.9");
	assert_address("10.0.0.1", "10.0.0.9", NULL, "10.0.0.9");
}

static void a_proxy_says_whom_it_was_asked_by(void **state)
{
	(void)state;
	assert_address("10.0.0.1", "10.0.0.1", "1.2.3.4", "1.2.3.4");
	assert_address("10.0.0.1,::1", "::1", "2001:db8::7", "2001:db8::7");
	assert_address("10.0.0.1", "10.0.0.1", NULL, "10.0.0.1");
}

static void ipv4_on_a_socket_of_ipv6_is_ipv4(void **state)
{
	(void)state;
	assert_address("10.0.0.1", "::ffff:10.0.0.1", "1.2.3.4", "1.2.3.4");
	assert_address("", "::ffff:10.0.0.9", NULL, "10.0.0.9");
	assert_address("", "::ffff:0:1", NULL, "::ffff:0:1");
}

static void only_what_our_proxies_wrote_is_believed(void **state)
{
	(void)state;
	// the client wrote 9.9.9.9; the proxy added the client's address
	assert_address("10.0.0.1", "10.0.0.1", "9.9.9.9, 1.2.3.4", "1.2.3.4");
	assert_address("10.0.0.1, 10.0.0.2", "10.0.0.1", "9.9.9.9,1.2.3.4 , 10.0.0.2", "1.2.3.4");
	assert_address("10.0.0.1, 10.0.0.2", "10.0.0.1", "10.0.0.2", "10.0.0.2");
}

static void what_is_no_address_is_not_believed(void **state)
{
	(void)state;
	assert_address("10.0.0.1", "10.0.0.1", "", "10.0.0.1");
	assert_address("10.0.0.1", "10.0.0.1", ",", "10.0.0.1");
	assert_address("10.0.0.1", "10.0.0.1", "unknown", "10.0.0.1");
	assert_address("10.0.0.1", "10.0.0.1", "1.2.3.4\" role=\"admin", "10.0.0.1");
	assert_address("10.0.0.1", "10.0.0.1",
	               "1.2.3.4.5.6.7.8.9.0.1.2.3.4.5.6.7.8.9.0.1.2.3.4.5.6.7.8.9.0.1.2.3.4.5.6.7.8",
	               "10.0.0.1");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(who_is_no_proxy_is_who_it_is),
		cmocka_unit_test(a_proxy_says_whom_it_was_asked_by),
		cmocka_unit_test(ipv4_on_a_socket_of_ipv6_is_ipv4),
		cmocka_unit_test(only_what_our_proxies_wrote_is_believed),
		cmocka_unit_test(what_is_no_address_is_not_believed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
