// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a proxy's answer about its daemons, and refuses other texts.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/fleet_json.h"

static cau_fleet fleet;

static cau_status read_text(const char *text, cau_error *error)
{
	return cau_fleet_from_json(text, strlen(text), &fleet, error);
}

static void labels_are_read_in_their_order(void **state)
{
	(void)state;
	cau_error error = {0};
	assert_int_equal(read_text("{\"labels\": [\"d2\", \"d1\", \"ward_3\"]}", &error), CAU_OK);
	assert_int_equal(fleet.count, 3);
	assert_string_equal(fleet.labels[0], "d2");
	assert_string_equal(fleet.labels[1], "d1");
	assert_string_equal(fleet.labels[2], "ward_3");
}

static void what_later_proxies_tell_besides_is_skipped(void **state)
{
	(void)state;
	cau_error error = {0};
	assert_int_equal(read_text("{\"site\": {\"a\": [1]}, \"labels\": [\"d1\"]}", &error), CAU_OK);
	assert_int_equal(fleet.count, 1);
	assert_int_equal(read_text("{\"labels\": []}", &error), CAU_OK); // a single daemon
	assert_int_equal(fleet.count, 0);
}

static void what_is_no_fleet_is_refused(void **state)
{
	(void)state;
	const struct {
		const char *text;
		cau_status status;
		const char *path;
	} cases[] = {
		{"<html></html>", CAU_BAD_SYNTAX, ""},
		{"", CAU_BAD_SYNTAX, ""},
		{"[\"d1\"]", CAU_BAD_VALUE, ""},
		{"{}", CAU_BAD_VALUE, "labels"},
		{"{\"labels\": \"d1\"}", CAU_BAD_VALUE, "labels"},
		{"{\"labels\": [\"d1\", 2]}", CAU_BAD_VALUE, "labels[1]"},
		{"{\"labels\": [\"d1\", \"D2\"]}", CAU_BAD_VALUE, "labels[1]"},
		{"{\"labels\": [\"d1\", \"\"]}", CAU_BAD_VALUE, "labels[1]"},
		{"{\"labels\": [\"d1\", \"d1\"]}", CAU_BAD_VALUE, "labels[1]"},
		{"{\"labels\": [\"d-1\"]}", CAU_BAD_VALUE, "labels[0]"},
		{"{\"labels\": [\"d1\"], \"labels\": [\"d2\"]}", CAU_BAD_SYNTAX, ""},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		cau_error error = {0};
		if (read_text(cases[i].text, &error) != cases[i].status)
			fail_msg("%s: %s", cases[i].text, cau_status_name(error.status));
		assert_string_equal(error.path, cases[i].path);
		assert_true(*error.reason);
		assert_int_equal(fleet.count, 0);
	}
}

// The largest fleet is accepted, and one with a label more is refused.
static void a_fleet_has_a_bound(void **state)
{
	(void)state;
	static char text[CAU_FLEET_JSON_MAX_BYTES];
	for (int extra = 0; extra < 2; extra++) {
		cau_error error = {0};
		size_t bytes = (size_t)snprintf(text, sizeof text, "{\"labels\": [\"d0\"");
		for (int i = 1; i < CAU_FLEET_LABELS_MAX + extra; i++)
			bytes += (size_t)snprintf(text + bytes, sizeof text - bytes, ",\"d%d\"", i);
		snprintf(text + bytes, sizeof text - bytes, "]}");
		assert_int_equal(read_text(text, &error), extra ? CAU_BAD_VALUE : CAU_OK);
		assert_int_equal(fleet.count, extra ? 0 : CAU_FLEET_LABELS_MAX);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(labels_are_read_in_their_order),
		cmocka_unit_test(what_later_proxies_tell_besides_is_skipped),
		cmocka_unit_test(what_is_no_fleet_is_refused),
		cmocka_unit_test(a_fleet_has_a_bound),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
