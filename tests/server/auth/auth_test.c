// SPDX-License-Identifier: GPL-3.0-or-later
#include "auth/auth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static cau_config settings(void)
{
	cau_config config;
	cau_config_default(&config);
	config.port = 8740;
	return config;
}

static void own_hosts_pass(void **state)
{
	(void)state;
	cau_config config = settings();
	assert_int_equal(cau_config_set(&config, "hosts", "sim.example, other.example:99", NULL),
	                 CAU_OK);
	static const char *const allowed[] = {"localhost",       "LOCALHOST:8740",  "127.0.0.1:8740",
	                                      "[::1]:8740",      "[::1]",           "sim.example",
	                                      "sim.example:443", "other.example:99"};
	static const char *const refused[] = {
		"",           "evil.example",        "localhost:1",   "127.0.0.1:0",      "127.0.0.1:x",
		"127.0.0.1:", "localhost.evil.test", "sim.example.x", "other.example:98", "127.0.0.2"};
	for (size_t i = 0; i < sizeof allowed / sizeof allowed[0]; i++)
		assert_true(cau_auth_host_allowed(&config, allowed[i]));
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
		assert_false(cau_auth_host_allowed(&config, refused[i]));
	assert_false(cau_auth_host_allowed(&config, NULL));
}

static void own_origins_pass(void **state)
{
	(void)state;
	cau_config config = settings();
	assert_int_equal(cau_config_set(&config, "origins", "https://page.example", NULL), CAU_OK);
	assert_true(cau_auth_origin_allowed(&config, NULL, "localhost:8740"));
	assert_true(cau_auth_origin_allowed(&config, "", "localhost:8740"));
	assert_true(cau_auth_origin_allowed(&config, "http://localhost:8740", "localhost:8740"));
	assert_true(cau_auth_origin_allowed(&config, "https://localhost:8740", "localhost:8740"));
	assert_true(cau_auth_origin_allowed(&config, "https://page.example", "localhost:8740"));
	assert_false(cau_auth_origin_allowed(&config, "http://localhost:3000", "localhost:8740"));
	assert_false(
		cau_auth_origin_allowed(&config, "http://localhost:8740.evil.test", "localhost:8740"));
	assert_false(cau_auth_origin_allowed(&config, "null", "localhost:8740"));
	assert_false(cau_auth_origin_allowed(&config, "https://page.example.evil", "localhost:8740"));
}

static cau_status read_tokens(const char *text, mode_t mode, cau_auth **auth)
{
	char file[] = "/tmp/cautery-tokens-XXXXXX";
	int descriptor = mkstemp(file);
	cau_config config = settings();
	assert_int_equal(write(descriptor, text, strlen(text)), (int)strlen(text));
	fchmod(descriptor, mode);
	close(descriptor);
	assert_int_equal(cau_config_set(&config, "tokens", file, NULL), CAU_OK);
	cau_status status = cau_auth_create(auth, &config, NULL);
	unlink(file);
	return status;
}

static bool role_is(const cau_auth *auth, const char *token, cau_role expected)
{
	cau_role role;
	return cau_auth_role(auth, token, strlen(token), &role) && role == expected;
}

static void tokens_have_roles(void **state)
{
	(void)state;
	cau_auth *auth;
	cau_role role;
	assert_int_equal(read_tokens("# all\nadmin 0123456789abcdef\n\nview fedcba9876543210 # looks\n",
	                             0600, &auth),
	                 CAU_OK);
	assert_true(cau_auth_required(auth));
	assert_true(role_is(auth, "0123456789abcdef", CAU_ROLE_ADMIN));
	assert_true(role_is(auth, "fedcba9876543210", CAU_ROLE_VIEW));
	assert_false(cau_auth_role(auth, "", 0, &role));
	assert_false(cau_auth_role(auth, "0123456789abcdee", 16, &role));
	assert_false(cau_auth_role(auth, "0123456789abcdef", 15, &role));
	cau_auth_destroy(auth);
}

static void wrong_token_files_are_refused(void **state)
{
	(void)state;
	cau_auth *auth;
	assert_int_equal(read_tokens("admin 0123456789abcdef\n", 0644, &auth), CAU_BAD_VALUE);
	assert_int_equal(read_tokens("", 0600, &auth), CAU_BAD_VALUE);
	assert_int_equal(read_tokens("root 0123456789abcdef\n", 0600, &auth), CAU_BAD_VALUE);
	assert_int_equal(read_tokens("admin short\n", 0600, &auth), CAU_BAD_VALUE);
	assert_int_equal(read_tokens("admin\n", 0600, &auth), CAU_BAD_SYNTAX);
	assert_int_equal(read_tokens("admin 0123456789abcdef more\n", 0600, &auth), CAU_BAD_SYNTAX);
	assert_null(auth);
}

static void without_tokens_everybody_is_admin(void **state)
{
	(void)state;
	cau_auth *auth;
	cau_config config = settings();
	assert_int_equal(cau_auth_create(&auth, &config, NULL), CAU_OK);
	assert_false(cau_auth_required(auth));
	assert_true(role_is(auth, "", CAU_ROLE_ADMIN));
	cau_auth_destroy(auth);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(own_hosts_pass),
		cmocka_unit_test(own_origins_pass),
		cmocka_unit_test(tokens_have_roles),
		cmocka_unit_test(wrong_token_files_are_refused),
		cmocka_unit_test(without_tokens_everybody_is_admin),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
