// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/roles.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static cau_config config;
static cau_dds_roles roles;
static cau_error error;

static cau_status read_text(const char *text)
{
	char file[] = "/tmp/cautery-roles-XXXXXX";
	int descriptor = mkstemp(file);
	assert_true(descriptor >= 0);
	assert_int_equal(write(descriptor, text, strlen(text)), strlen(text));
	assert_int_equal(close(descriptor), 0);
	snprintf(config.dds_roles, sizeof config.dds_roles, "%s", file);
	error = (cau_error){0};
	cau_status status = cau_dds_roles_read(&roles, &config, &error);
	assert_int_equal(unlink(file), 0);
	return status;
}

static int set_up(void **state)
{
	(void)state;
	cau_config_default(&config);
	return 0;
}

static void without_a_file_everybody_has_the_one_role(void **state)
{
	(void)state;
	assert_int_equal(cau_dds_roles_read(&roles, &config, &error), CAU_OK);
	assert_int_equal(cau_dds_roles_find(&roles, NULL), CAU_ROLE_OPERATE);
	assert_int_equal(cau_dds_roles_find(&roles, "CN=a"), CAU_ROLE_OPERATE);
}

static void a_file_names_identities_and_who_proves_none_may_view(void **state)
{
	(void)state;
	assert_int_equal(read_text("# robots\n\nadmin CN=chief,O=Cautery\n"
	                           "\t view   CN=Looks On #1,O=Cautery \t\r\n"),
	                 CAU_OK);
	assert_int_equal(cau_dds_roles_find(&roles, "CN=chief,O=Cautery"), CAU_ROLE_ADMIN);
	assert_int_equal(cau_dds_roles_find(&roles, "CN=Looks On #1,O=Cautery"), CAU_ROLE_VIEW);
	assert_int_equal(cau_dds_roles_find(&roles, "CN=chief,O=Cautery,C=XX"), CAU_ROLE_OPERATE);
	assert_int_equal(cau_dds_roles_find(&roles, "CN=chief"), CAU_ROLE_OPERATE);
	assert_int_equal(cau_dds_roles_find(&roles, NULL), CAU_ROLE_VIEW);
}

static void fails(const char *text, cau_status status, const char *reason)
{
	assert_int_equal(read_text(text), status);
	assert_string_equal(error.path, "dds_roles");
	assert_non_null(strstr(error.reason, reason));
}

static void what_cannot_be_read_is_refused_with_its_line(void **state)
{
	(void)state;
	char text[CAU_CONFIG_TEXT_BYTES * 2] = "view CN=";
	fails("\nking CN=a\n", CAU_BAD_VALUE, "line 2");
	fails("viewer CN=a\n", CAU_BAD_VALUE, "line 1");
	fails("view\n", CAU_BAD_SYNTAX, "line 1");
	fails("view knee-robot\n", CAU_BAD_SYNTAX, "line 1");
	fails("view CN=a\nview CN=b\nadmin CN=a\n", CAU_BAD_VALUE, "line 3");
	memset(text + strlen(text), 'a', CAU_DDS_SUBJECT_BYTES);
	fails(text, CAU_BAD_SYNTAX, "line 1"); // a name so long that no participant could prove it
	memset(text + strlen(text), 'a', CAU_CONFIG_TEXT_BYTES);
	fails(text, CAU_LIMIT, "line 1");
}

static void a_file_that_is_not_there_or_too_long_is_refused(void **state)
{
	(void)state;
	enum { LINE_BYTES = 32 };
	char *text = calloc(CAU_DDS_ROLES_MOST + 2, LINE_BYTES);
	assert_non_null(text);
	for (int i = 0; i <= CAU_DDS_ROLES_MOST; i++)
		snprintf(text + strlen(text), LINE_BYTES, "view CN=robot-%d\n", i);
	fails(text, CAU_LIMIT, "more than");
	free(text);
	snprintf(config.dds_roles, sizeof config.dds_roles, "/nowhere/roles");
	assert_int_equal(cau_dds_roles_read(&roles, &config, &error), CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(without_a_file_everybody_has_the_one_role, set_up),
		cmocka_unit_test_setup(a_file_names_identities_and_who_proves_none_may_view, set_up),
		cmocka_unit_test_setup(what_cannot_be_read_is_refused_with_its_line, set_up),
		cmocka_unit_test_setup(a_file_that_is_not_there_or_too_long_is_refused, set_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
