// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/internal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

// Returns ROS 2's default QoS, for a writer or a reader.
static dds_qos_t *usual(void)
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
	dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
	dds_qset_ownership(qos, DDS_OWNERSHIP_SHARED);
	return qos;
}

static void expect(dds_qos_t *offered, dds_qos_t *requested, const char *policy)
{
	const char *wrong = cau_dds_mismatch(offered, requested);
	if (policy)
		assert_string_equal(wrong, policy);
	else
		assert_null(wrong);
	dds_delete_qos(offered);
	dds_delete_qos(requested);
}

static void what_is_usual_matches(void **state)
{
	(void)state;
	expect(usual(), usual(), NULL);
	expect(dds_create_qos(), dds_create_qos(), NULL); // DDS's own defaults
}

static void less_than_requested_is_named(void **state)
{
	(void)state;
	dds_qos_t *qos = usual();
	dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
	expect(qos, usual(), "reliability");
	qos = usual();
	dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
	expect(usual(), qos, "durability");
	qos = usual();
	dds_qset_deadline(qos, DDS_MSECS(100));
	expect(usual(), qos, "deadline");
	qos = usual();
	dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(100));
	expect(usual(), qos, "liveliness");
	qos = usual();
	dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
	expect(qos, usual(), "ownership");
}

static void more_than_requested_matches(void **state)
{
	(void)state;
	dds_qos_t *qos = usual();
	dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
	dds_qset_deadline(qos, DDS_MSECS(100));
	dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(100));
	expect(qos, usual(), NULL);
	qos = usual();
	dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
	expect(usual(), qos, NULL);
}

// Only reliability has a remedy, so it is named only if nothing else is wrong.
static void reliability_is_named_last(void **state)
{
	(void)state;
	dds_qos_t *qos = usual();
	dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
	dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
	expect(qos, usual(), "ownership");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_usual_matches),
		cmocka_unit_test(less_than_requested_is_named),
		cmocka_unit_test(more_than_requested_matches),
		cmocka_unit_test(reliability_is_named_last),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
