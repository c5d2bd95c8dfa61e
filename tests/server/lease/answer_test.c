// SPDX-License-Identifier: GPL-3.0-or-later
// Reads answers as etcd 3.4 writes them, and refuses other texts.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "lease/etcd.h"

#define HEADER                                                                                     \
	"\"header\":{\"cluster_id\":\"14841639068965178418\",\"member_id\":\"10276657743932975437\","  \
	"\"revision\":\"12\",\"raft_term\":\"2\"}"

static const char *const keys[] = {"cautery/d1/generation", "cautery/d1/holder"};

static void leases_are_read(void **state)
{
	(void)state;
	cau_etcd_lease lease;
	static const struct {
		const char *text;
		int64_t id;
		double ttl_s;
	} cases[] = {
		{"{" HEADER ",\"ID\":\"7587881763475341322\",\"TTL\":\"15\"}", 7587881763475341322, 15},
		{"{\"result\":{" HEADER ",\"ID\":\"12\",\"TTL\":\"15\"}}\n", 12, 15},
		{"{\"result\":{" HEADER ",\"ID\":\"12\"}}", 12, 0},
		{" { \"TTL\" : \"3\" , \"note\" : [ { \"ID\" : \"5\" } , \"}\\\"\" , 1.5e3 , null ] , "
	     "\"ID\" : \"12\" } ",
	     12, 3},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		cau_error error = {0};
		if (cau_etcd_read_lease(cases[i].text, strlen(cases[i].text), &lease, &error))
			fail_msg("%s: %s", cases[i].text, error.reason);
		assert_true(lease.id == cases[i].id && lease.ttl_s == cases[i].ttl_s);
	}
}

static void what_is_no_lease_is_refused(void **state)
{
	(void)state;
	cau_etcd_lease lease;
	static const char *const texts[] = {"",
	                                    "[]",
	                                    "null",
	                                    "{",
	                                    "{}",
	                                    "{\"TTL\":\"15\"}",
	                                    "{\"ID\":12,\"TTL\":\"15\"}",
	                                    "{\"ID\":\"\",\"TTL\":\"15\"}",
	                                    "{\"ID\":\"0\",\"TTL\":\"15\"}",
	                                    "{\"ID\":\"-4\",\"TTL\":\"15\"}",
	                                    "{\"ID\":\"1-2\",\"TTL\":\"15\"}",
	                                    "{\"ID\":\"99999999999999999999\",\"TTL\":\"15\"}",
	                                    "{\"ID\":\"12\",\"TTL\":15}",
	                                    "{\"ID\":\"12\",\"TTL\":\"15\",\"ID\":\"13\"}",
	                                    "{\"result\":\"ID\"}",
	                                    "{\"error\":\"etcdserver: no leader\",\"code\":14}"};
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		cau_error error = {0};
		if (cau_etcd_read_lease(texts[i], strlen(texts[i]), &lease, &error) != CAU_CORRUPT)
			fail_msg("%s was read", texts[i]);
		assert_true(*error.reason);
	}
}

static cau_status read_values(const char *text, cau_etcd_value values[2])
{
	cau_error error = {0};
	return cau_etcd_read_values(text, strlen(text), keys, values, 2, &error);
}

static void values_are_read(void **state)
{
	(void)state;
	cau_etcd_value values[2];
	assert_int_equal(read_values("{" HEADER "}", values), CAU_OK); // etcd has neither key
	assert_false(values[0].is_there || values[1].is_there);
	assert_int_equal(
		read_values(
			"{" HEADER ",\"kvs\":[{\"key\":\"Y2F1dGVyeS9kMS9nZW5lcmF0aW9u\","
			"\"create_revision\":\"2\",\"mod_revision\":\"7\",\"version\":\"3\",\"value\":"
			"\"MTc6MDA=\"},{\"key\":\"Y2F1dGVyeS9kMS9ob2xkZXI=\",\"create_revision\":\"7\","
			"\"mod_revision\":\"8\",\"value\":\"bWU=\",\"lease\":\"99\"},{\"key\":\"YQ==\"}],"
			"\"count\":\"3\"}",
			values),
		CAU_OK);
	assert_true(values[0].is_there && values[0].revision == 7 && values[0].lease == 0);
	assert_int_equal(values[0].bytes, 5);
	assert_memory_equal(values[0].text, "17:00", 5);
	assert_true(values[1].is_there && values[1].revision == 8 && values[1].lease == 99);
	assert_int_equal(values[1].bytes, 2);
}

#define KEY "\"key\":\"Y2F1dGVyeS9kMS9ob2xkZXI=\""

static void what_are_no_values_is_refused(void **state)
{
	(void)state;
	cau_etcd_value values[2];
	static const char *const texts[] = {
		"{}",
		"{" HEADER ",\"kvs\":{}}",
		"{" HEADER ",\"kvs\":[1]}",
		"{" HEADER ",\"kvs\":[{}]}",
		"{" HEADER ",\"kvs\":[{" KEY "}]}",
		"{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"0\"}]}",
		"{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"1\",\"value\":\"abc\"}]}",
		"{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"1\",\"value\":\"a===\"}]}",
		"{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"1\",\"value\":\"a=bc\"}]}",
		"{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"1\",\"value\":\"a\\u0041bc\"}]}",
		"{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"1\",\"value\":7}]}",
		"{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"1\"},{" KEY ",\"mod_revision\":\"1\"}]}",
	};
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		if (read_values(texts[i], values) != CAU_CORRUPT)
			fail_msg("%s was read", texts[i]);
}

static void a_value_has_a_bound(void **state)
{
	(void)state;
	char text[1024];
	cau_etcd_value values[2];
	for (int more = 0; more < 2; more++) {
		// These are the base64 lengths of 255 bytes, and of three bytes more.
		int length = 340 + 4 * more;
		snprintf(text, sizeof text,
		         "{" HEADER ",\"kvs\":[{" KEY ",\"mod_revision\":\"1\",\"value\":\"%0*d\"}]}",
		         length, 0);
		assert_int_equal(read_values(text, values), more ? CAU_CORRUPT : CAU_OK);
		assert_true(more || values[1].bytes == 255);
	}
}

static void outcomes_are_read(void **state)
{
	(void)state;
	bool success = true;
	static const struct {
		const char *text;
		cau_status status;
		bool success;
	} cases[] = {
		{"{" HEADER ",\"succeeded\":true,\"responses\":[{\"response_put\":{}}]}", CAU_OK, true},
		{"{" HEADER ",\"succeeded\":false}", CAU_OK, false},
		{"{" HEADER "}", CAU_OK, false},
		{"{\"succeeded\":true}", CAU_CORRUPT, false},
		{"{" HEADER ",\"succeeded\":\"true\"}", CAU_CORRUPT, false},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		cau_error error = {0};
		assert_int_equal(
			cau_etcd_read_success(cases[i].text, strlen(cases[i].text), &success, &error),
			cases[i].status);
		assert_int_equal(success, cases[i].success);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(leases_are_read),     cmocka_unit_test(what_is_no_lease_is_refused),
		cmocka_unit_test(values_are_read),     cmocka_unit_test(what_are_no_values_is_refused),
		cmocka_unit_test(a_value_has_a_bound), cmocka_unit_test(outcomes_are_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
