// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/config.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "config/setting.h"

static char *no_environment[] = {NULL};

static cau_status load(cau_config *config, int count, char **arguments, char **environment,
                       cau_error *error)
{
	cau_config_request request;
	return cau_config_load(config, &request, count, arguments, environment, error);
}

static void defaults_are_the_table(void **state)
{
	(void)state;
	cau_config config;
	char *arguments[] = {"cauteryd"};
	assert_int_equal(load(&config, 1, arguments, no_environment, NULL), CAU_OK);
	assert_int_equal(config.port, 8740);
	assert_string_equal(config.listen, "127.0.0.1");
	assert_true(config.browser_deadline_s == 0.25);
	assert_false(config.dds);
}

static void every_default_is_in_its_range(void **state)
{
	(void)state;
	cau_config config;
	cau_config_default(&config);
	for (size_t i = 0; i < cau_setting_count; i++)
		assert_int_equal(
			cau_config_set(&config, cau_settings[i].name, cau_settings[i].default_text, NULL),
			CAU_OK);
}

static void flags_are_spelled_both_ways(void **state)
{
	(void)state;
	cau_config config;
	char *arguments[] = {"cauteryd", "--max-sessions", "7", "--checkpoint_s=2.5", "--dds"};
	assert_int_equal(load(&config, 5, arguments, no_environment, NULL), CAU_OK);
	assert_int_equal(config.max_sessions, 7);
	assert_true(config.checkpoint_s == 2.5);
	assert_true(config.dds);
	char *off[] = {"cauteryd", "--dds", "false", "--port", "81"};
	assert_int_equal(load(&config, 5, off, no_environment, NULL), CAU_OK);
	assert_false(config.dds);
	assert_int_equal(config.port, 81);
}

static void environment_is_below_flags(void **state)
{
	(void)state;
	cau_config config;
	char *arguments[] = {"cauteryd", "--port", "1"};
	char *environment[] = {"CAUTERY_PORT=2", "CAUTERY_LABEL=d9", "CAUTERY_MESHES=/x", "PATH=/bin",
	                       NULL};
	assert_int_equal(load(&config, 3, arguments, environment, NULL), CAU_OK);
	assert_int_equal(config.port, 1);
	assert_string_equal(config.label, "d9");
}

static void refuses(char *argument, cau_status expected, const char *path)
{
	cau_config config;
	cau_error error = {0};
	char *arguments[] = {"cauteryd", argument};
	assert_int_equal(load(&config, 2, arguments, no_environment, &error), expected);
	assert_non_null(strstr(error.path, path));
	assert_true(*error.reason);
}

static void wrong_settings_are_refused(void **state)
{
	(void)state;
	refuses("--speed=3", CAU_NOT_FOUND, "--speed");
	refuses("port", CAU_BAD_SYNTAX, "port");
	refuses("--port", CAU_BAD_SYNTAX, "--port");
	refuses("--port=80x", CAU_BAD_VALUE, "port");
	refuses("--port=65536", CAU_BAD_VALUE, "port");
	refuses("--resume-s=nan", CAU_BAD_VALUE, "resume_s");
	refuses("--dds=maybe", CAU_BAD_VALUE, "dds");
	refuses("--listen=10.0.0.1", CAU_BAD_VALUE, "listen");
	refuses("--tls-certificate=cert.pem", CAU_BAD_VALUE, "tls_key");
	refuses("--tls-key=key.pem", CAU_BAD_VALUE, "tls_certificate");
}

static void beyond_loopback_it_wants_tokens_and_tls_or_a_proxy(void **state)
{
	(void)state;
	static char listen[] = "--listen=10.0.0.1", tokens[] = "--tokens=t", proxy[] = "--tls-by-proxy",
				certificate[] = "--tls-certificate=c", key[] = "--tls-key=k";
	char *const attempts[][4] = {{listen, tokens},
	                             {listen, proxy},
	                             {listen, certificate, key},
	                             {listen, tokens, proxy},
	                             {listen, tokens, certificate, key}};
	static const int words[] = {2, 2, 3, 3, 4};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		cau_config config;
		cau_error error = {0};
		char *arguments[] = {(char[]){"cauteryd"}, attempts[i][0], attempts[i][1], attempts[i][2],
		                     attempts[i][3]};
		cau_status status = load(&config, words[i] + 1, arguments, no_environment, &error);
		assert_int_equal(status, i < 3 ? CAU_BAD_VALUE : CAU_OK);
		assert_string_equal(error.path, i < 3 ? "listen" : "");
	}
}

static cau_status read_text(const char *text, cau_config *config, cau_error *error)
{
	char file[] = "/tmp/cautery-config-XXXXXX";
	int descriptor = mkstemp(file);
	assert_true(descriptor >= 0);
	assert_int_equal(write(descriptor, text, strlen(text)), (int)strlen(text));
	close(descriptor);
	cau_config_default(config);
	cau_status status = cau_config_read_file(config, file, error);
	unlink(file);
	return status;
}

static void files_are_flat_objects(void **state)
{
	(void)state;
	cau_config config;
	assert_int_equal(
		read_text(" {\n\"port\" : 81 , \"label\":\"a\\\"b\", \"dds\":true}\n", &config, NULL),
		CAU_OK);
	assert_int_equal(config.port, 81);
	assert_string_equal(config.label, "a\"b");
	assert_true(config.dds);
	assert_int_equal(read_text("{}", &config, NULL), CAU_OK);
}

static void wrong_files_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		cau_status status;
	} wrong[] = {
		{"", CAU_BAD_SYNTAX},
		{"{\"port\": 80,}", CAU_BAD_SYNTAX},
		{"{\"port\": 80} 1", CAU_BAD_SYNTAX},
		{"[80]", CAU_BAD_VALUE},
		{"{\"speed\": 1}", CAU_NOT_FOUND},
		{"{\"max-sessions\": 1}", CAU_NOT_FOUND},
		{"{\"port\": \"80\"}", CAU_BAD_VALUE},
		{"{\"label\": 80}", CAU_BAD_VALUE},
		{"{\"port\": {\"a\": 1}}", CAU_BAD_VALUE},
		{"{\"port\": null}", CAU_BAD_VALUE},
	};
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		cau_config config;
		cau_error error = {0};
		assert_int_equal(read_text(wrong[i].text, &config, &error), wrong[i].status);
		assert_true(*error.file);
	}
	cau_config config;
	assert_int_equal(cau_config_read_file(&config, "/nowhere/at/all", NULL), CAU_IO);
}

static void what_is_printed_can_be_read(void **state)
{
	(void)state;
	cau_config first, second;
	char *text = NULL;
	size_t bytes = 0;
	cau_config_default(&first);
	assert_int_equal(cau_config_set(&first, "label", "quote\"back\\slash", NULL), CAU_OK);
	assert_int_equal(cau_config_set(&first, "resume_s", "0.1", NULL), CAU_OK);
	FILE *stream = open_memstream(&text, &bytes);
	cau_config_print(&first, stream);
	fclose(stream);
	assert_int_equal(read_text(text, &second, NULL), CAU_OK);
	assert_string_equal(second.label, first.label);
	assert_true(second.resume_s == first.resume_s);
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(defaults_are_the_table),
		cmocka_unit_test(every_default_is_in_its_range),
		cmocka_unit_test(flags_are_spelled_both_ways),
		cmocka_unit_test(environment_is_below_flags),
		cmocka_unit_test(wrong_settings_are_refused),
		cmocka_unit_test(beyond_loopback_it_wants_tokens_and_tls_or_a_proxy),
		cmocka_unit_test(files_are_flat_objects),
		cmocka_unit_test(wrong_files_are_refused),
		cmocka_unit_test(what_is_printed_can_be_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
