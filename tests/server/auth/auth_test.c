// SPDX-License-Identifier: GPL-3.0-or-later
#include "auth/auth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/sha256.h"

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
	static const char *const values[] = {
		"admin sha256:abc\n", "admin 0123456789abcdef expires=2027-01-31\n",
		"admin 0123456789abcdef expires=2027-01-31T12:00:00Zx\n",
		"admin sha256:0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdeF\n"};
	for (size_t i = 0; i < sizeof values / sizeof *values; i++)
		assert_int_equal(read_tokens(values[i], 0600, &auth), CAU_BAD_VALUE);
	assert_int_equal(read_tokens("admin 0123456789abcdef name=\n", 0600, &auth), CAU_BAD_SYNTAX);
	assert_null(auth);
}

static void a_hash_stands_for_its_token(void **state)
{
	(void)state;
	cau_auth *auth;
	char hash[CAU_SHA256_TEXT_BYTES], text[400], name[CAU_AUTH_NAME_BYTES];
	assert_true(cau_sha256("0123456789abcdef", 16, hash));
	snprintf(text, sizeof text, "operate sha256:%s name=anna expires=2999-01-01T00:00:00Z # hers\n",
	         hash);
	assert_int_equal(read_tokens(text, 0600, &auth), CAU_OK);
	assert_true(role_is(auth, "0123456789abcdef", CAU_ROLE_OPERATE));
	// The hash from the file is not a token, so a person who reads the file gets no access.
	assert_false(cau_auth_role(auth, hash, 64, &(cau_role){0}));
	cau_auth_grant_name(auth, cau_auth_grant(auth, "0123456789abcdef", 16), name);
	assert_string_equal(name, "anna");
	cau_auth_destroy(auth);
}

static void a_token_expires(void **state)
{
	(void)state;
	cau_auth *auth;
	char text[200];
	struct timespec now;
	struct tm utc;
	clock_gettime(CLOCK_REALTIME, &now);
	now.tv_sec += 2;
	gmtime_r(&now.tv_sec, &utc);
	strftime(text, sizeof text, "view 0123456789abcdef expires=%Y-%m-%dT%H:%M:%SZ\n", &utc);
	assert_int_equal(read_tokens(text, 0600, &auth), CAU_OK);
	cau_role role;
	uint64_t grant = cau_auth_grant(auth, "0123456789abcdef", 16);
	assert_true(grant && cau_auth_grant_role(auth, grant, &role));
	now.tv_nsec = 0;
	assert_int_equal(clock_nanosleep(CLOCK_REALTIME, TIMER_ABSTIME, &now, NULL), 0);
	assert_false(cau_auth_grant_role(auth, grant, &role));
	assert_false(cau_auth_role(auth, "0123456789abcdef", 16, &role));
	cau_auth_destroy(auth);
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

static char reload_file[64];
static cau_config reload_config;

static void write_tokens(const char *text, mode_t mode)
{
	FILE *file = fopen(reload_file, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(chmod(reload_file, mode), 0);
}

static int begin_reload(void **state)
{
	strcpy(reload_file, "/tmp/cautery-tokens-XXXXXX");
	close(mkstemp(reload_file));
	reload_config = settings();
	cau_config_set(&reload_config, "tokens", reload_file, NULL);
	write_tokens("admin 0123456789abcdef\noperate fedcba9876543210\n", 0600);
	return cau_auth_create((cau_auth **)state, &reload_config, NULL) ? -1 : 0;
}

static int end_reload(void **state)
{
	cau_auth_destroy(*state);
	return unlink(reload_file);
}

// A grant stays the same as long as its token is in the file, on any line and with any role.
static void a_grant_follows_its_token(void **state)
{
	cau_auth *auth = *state;
	cau_role role;
	uint64_t first = cau_auth_grant(auth, "0123456789abcdef", 16);
	uint64_t second = cau_auth_grant(auth, "fedcba9876543210", 16);
	assert_true(first && second && first != second);
	assert_int_equal(cau_auth_grant(auth, "fedcba9876543211", 16), 0);
	write_tokens("# turned\nview fedcba9876543210\nadmin newnewnewnewnewnew\n", 0600);
	assert_int_equal(cau_auth_reload(auth, &reload_config, NULL), CAU_OK);
	assert_false(cau_auth_grant_role(auth, first, &role));
	assert_true(cau_auth_grant_role(auth, second, &role) && role == CAU_ROLE_VIEW);
	assert_false(cau_auth_grant_role(auth, 0, &role));
	assert_false(cau_auth_role(auth, "0123456789abcdef", 16, &role));
	// the same token again gets a new grant, so older connections with it stay closed
	write_tokens("admin 0123456789abcdef\n", 0600);
	assert_int_equal(cau_auth_reload(auth, &reload_config, NULL), CAU_OK);
	assert_false(cau_auth_grant_role(auth, first, &role));
	assert_true(cau_auth_grant(auth, "0123456789abcdef", 16) > second);
}

// Whatever is wrong in the file, the old tokens stay, and the error says where the mistake is.
static void a_broken_file_changes_nothing(void **state)
{
	cau_auth *auth = *state;
	char long_line[600];
	memset(long_line, '#', sizeof long_line);
	long_line[sizeof long_line - 1] = 0;
	const struct {
		const char *text;
		mode_t mode;
		const char *reason;
	} broken[] = {
		{"admin 0123456789abcdef\n\nroot fedcba9876543210\n", 0600, "line 3"},
		{"view aaaaaaaaaaaaaaaa\nview short\n", 0600, "line 2"},
		{"view\n", 0600, "line 1"},
		{long_line, 0600, "line 1 is longer than 510 bytes"},
		{"# none\n", 0600, "contains no token"},
		{"", 0600, "contains no token"},
		{"view aaaaaaaaaaaaaaaa\n", 0640, "read by other users"},
	};
	for (size_t i = 0; i < sizeof broken / sizeof broken[0]; i++) {
		cau_error error = {0};
		write_tokens(broken[i].text, broken[i].mode);
		assert_int_not_equal(cau_auth_reload(auth, &reload_config, &error), CAU_OK);
		assert_non_null(strstr(error.reason, broken[i].reason));
		assert_string_equal(error.file, reload_file);
		assert_true(role_is(auth, "0123456789abcdef", CAU_ROLE_ADMIN));
		assert_true(role_is(auth, "fedcba9876543210", CAU_ROLE_OPERATE));
	}
	cau_config elsewhere = reload_config;
	cau_config_set(&elsewhere, "tokens", "/nowhere/tokens", NULL);
	assert_int_equal(cau_auth_reload(auth, &elsewhere, NULL), CAU_IO);
	assert_true(role_is(auth, "0123456789abcdef", CAU_ROLE_ADMIN));
}

static void without_tokens_a_grant_is_everybodys(void **state)
{
	(void)state;
	cau_auth *auth;
	cau_role role;
	cau_config config = settings();
	assert_int_equal(cau_auth_create(&auth, &config, NULL), CAU_OK);
	uint64_t grant = cau_auth_grant(auth, "", 0);
	assert_int_equal(cau_auth_reload(auth, &config, NULL), CAU_OK);
	assert_true(cau_auth_grant_role(auth, grant, &role) && role == CAU_ROLE_ADMIN);
	cau_auth_destroy(auth);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(own_hosts_pass),
		cmocka_unit_test(own_origins_pass),
		cmocka_unit_test(tokens_have_roles),
		cmocka_unit_test(wrong_token_files_are_refused),
		cmocka_unit_test(a_hash_stands_for_its_token),
		cmocka_unit_test(a_token_expires),
		cmocka_unit_test(without_tokens_everybody_is_admin),
		cmocka_unit_test_setup_teardown(a_grant_follows_its_token, begin_reload, end_reload),
		cmocka_unit_test_setup_teardown(a_broken_file_changes_nothing, begin_reload, end_reload),
		cmocka_unit_test(without_tokens_a_grant_is_everybodys),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
