// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/url.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void addresses_are_read(void **state)
{
	(void)state;
	const struct {
		const char *text, *host;
		int port;
		bool tls;
	} cases[] = {
		{"ws://127.0.0.1:8740", "127.0.0.1", 8740, false},
		{"http://localhost", "localhost", 8740, false},
		{"wss://tissue.example/v1", "tissue.example", 443, true},
		{"https://tissue.example:8443/", "tissue.example", 8443, true},
		{"ws://[::1]:1", "::1", 1, false},
		{"ws://[fe80::1%25lo]", "fe80::1%25lo", 8740, false},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		cau_url url;
		cau_error error = {0};
		if (cau_url_read(cases[i].text, &url, &error))
			fail_msg("%s: %s", cases[i].text, error.reason);
		assert_string_equal(url.host, cases[i].host);
		assert_int_equal(url.port, cases[i].port);
		assert_int_equal(url.tls, cases[i].tls);
	}
}

static void what_is_no_address_is_refused(void **state)
{
	(void)state;
	char endless[400] = "ws://";
	memset(endless + 5, 'a', sizeof endless - 6);
	endless[sizeof endless - 1] = 0;
	const char *const cases[] = {
		"",          "localhost:8740",  "ftp://a",       "ws://",
		"ws://:1",   "ws://[::1",       "ws://a:0",      "ws://a:65536",
		"ws://a:1x", "ws://a: 1",       "ws://a:-1",     "ws://a/v1?token=",
		"ws://a/v2", "ws://u:p@a:8740", "ws://a b",      "ws://a\r\nX: y",
		"ws://a[b",  "ws://[a\n]",      "ws://\xc3\xa4", endless,
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		cau_url url;
		cau_error error = {0};
		if (cau_url_read(cases[i], &url, &error) != CAU_BAD_VALUE)
			fail_msg("\"%s\" is taken for an address", cases[i]);
		assert_string_equal(error.path, "url");
		assert_true(strlen(error.reason) > 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(addresses_are_read),
		cmocka_unit_test(what_is_no_address_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
