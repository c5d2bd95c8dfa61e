// SPDX-License-Identifier: GPL-3.0-or-later
// Compares both formats byte by byte.
#include "metrics/exposition.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static const cau_metric_family spent = {"spent_seconds", CAU_METRIC_COUNTER, "seconds",
                                        "Time \"spent\" \\ lost\nand found"};
static const cau_metric_family open_doors = {"doors", CAU_METRIC_GAUGE, "", "Doors open"};

static void is_written(cau_metrics_format format, const char *expected)
{
	char *text = NULL;
	size_t bytes = 0;
	FILE *out = open_memstream(&text, &bytes);
	assert_non_null(out);
	cau_metrics_begin(out, format, &spent);
	cau_metrics_sample(out, format, &spent, "session", "d1-a\"b\\c\nd\xc3\xa9", 0.5);
	cau_metrics_sample(out, format, &spent, "session", "d1-e", 3e21);
	cau_metrics_begin(out, format, &open_doors);
	cau_metrics_sample(out, format, &open_doors, NULL, NULL, -2);
	cau_metrics_end(out, format);
	assert_int_equal(fclose(out), 0);
	assert_string_equal(text, expected);
	free(text);
}

static void text_is_0_0_4(void **state)
{
	(void)state;
	is_written(CAU_METRICS_TEXT,
	           "# TYPE cautery_spent_seconds_total counter\n"
	           "# HELP cautery_spent_seconds_total Time \"spent\" \\\\ lost\\nand found\n"
	           "cautery_spent_seconds_total{session=\"d1-a\\\"b\\\\c\\nd\xc3\xa9\"} 0.5\n"
	           "cautery_spent_seconds_total{session=\"d1-e\"} 3e+21\n"
	           "# TYPE cautery_doors gauge\n"
	           "# HELP cautery_doors Doors open\n"
	           "cautery_doors -2\n");
}

static void openmetrics_is_1_0_0(void **state)
{
	(void)state;
	is_written(CAU_METRICS_OPEN,
	           "# TYPE cautery_spent_seconds counter\n"
	           "# UNIT cautery_spent_seconds seconds\n"
	           "# HELP cautery_spent_seconds Time \\\"spent\\\" \\\\ lost\\nand found\n"
	           "cautery_spent_seconds_total{session=\"d1-a\\\"b\\\\c\\nd\xc3\xa9\"} 0.5\n"
	           "cautery_spent_seconds_total{session=\"d1-e\"} 3e+21\n"
	           "# TYPE cautery_doors gauge\n"
	           "# HELP cautery_doors Doors open\n"
	           "cautery_doors -2\n"
	           "# EOF\n");
}

static const cau_metric_family waited = {"waited_seconds", CAU_METRIC_HISTOGRAM, "seconds",
                                         "Waits"};

static void a_histogram_is_told_from_its_least_bucket_up(void **state)
{
	(void)state;
	char *text = NULL;
	size_t bytes = 0;
	FILE *out = open_memstream(&text, &bytes);
	const double bounds[] = {0.0005, 1};
	const uint64_t counts[] = {3, 2, 1};
	cau_metrics_begin(out, CAU_METRICS_TEXT, &waited);
	cau_metrics_histogram(out, CAU_METRICS_TEXT, &waited, &(cau_metric_label){"stage", "a\"b"}, 1,
	                      &(cau_buckets){bounds, 2, counts, 7.5});
	cau_metrics_histogram(out, CAU_METRICS_TEXT, &waited, NULL, 0,
	                      &(cau_buckets){NULL, 0, &counts[2], 2});
	assert_int_equal(fclose(out), 0);
	assert_string_equal(text, "# TYPE cautery_waited_seconds histogram\n"
	                          "# HELP cautery_waited_seconds Waits\n"
	                          "cautery_waited_seconds_bucket{stage=\"a\\\"b\",le=\"0.0005\"} 3\n"
	                          "cautery_waited_seconds_bucket{stage=\"a\\\"b\",le=\"1\"} 5\n"
	                          "cautery_waited_seconds_bucket{stage=\"a\\\"b\",le=\"+Inf\"} 6\n"
	                          "cautery_waited_seconds_sum{stage=\"a\\\"b\"} 7.5\n"
	                          "cautery_waited_seconds_count{stage=\"a\\\"b\"} 6\n"
	                          "cautery_waited_seconds_bucket{le=\"+Inf\"} 1\n"
	                          "cautery_waited_seconds_sum 2\n"
	                          "cautery_waited_seconds_count 1\n");
	free(text);
}

static void samples_may_have_several_labels(void **state)
{
	(void)state;
	char *text = NULL;
	size_t bytes = 0;
	FILE *out = open_memstream(&text, &bytes);
	const cau_metric_label labels[] = {{"method", "tool.move"}, {"code", "ok"}};
	cau_metrics_sample_labelled(out, CAU_METRICS_TEXT, &spent, labels, 2, 4);
	assert_int_equal(fclose(out), 0);
	assert_string_equal(text, "cautery_spent_seconds_total{method=\"tool.move\",code=\"ok\"} 4\n");
	free(text);
}

static void what_is_not_finite_has_its_own_words(void **state)
{
	(void)state;
	static const double values[] = {INFINITY, -INFINITY, NAN, -NAN};
	char *text = NULL;
	size_t bytes = 0;
	FILE *out = open_memstream(&text, &bytes);
	assert_non_null(out);
	for (size_t i = 0; i < sizeof values / sizeof *values; i++)
		cau_metrics_sample(out, CAU_METRICS_TEXT, &open_doors, NULL, NULL, values[i]);
	assert_int_equal(fclose(out), 0);
	assert_string_equal(text, "cautery_doors +Inf\ncautery_doors -Inf\n"
	                          "cautery_doors NaN\ncautery_doors NaN\n");
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(text_is_0_0_4),
		cmocka_unit_test(openmetrics_is_1_0_0),
		cmocka_unit_test(a_histogram_is_told_from_its_least_bucket_up),
		cmocka_unit_test(samples_may_have_several_labels),
		cmocka_unit_test(what_is_not_finite_has_its_own_words),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
