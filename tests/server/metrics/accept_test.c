// SPDX-License-Identifier: GPL-3.0-or-later
// Checks which format an Accept header gets.
#include "metrics/exposition.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

static const char *const get_text[] = {
	"",
	"*/*",
	"text/html, application/xhtml+xml, */*;q=0.8",
	"text/plain",
	"text/plain;version=0.0.4",
	"application/json",
	"application/openmetrics-text;q=0",
	"application/openmetrics-text;q=0.0, */*",
	// the range application/openmetrics-text is more specific, so its q is used
	"application/openmetrics-text;q=0, application/*",
	"application/openmetrics-text; q=0.3, text/plain;q=0.9", // OpenMetrics has a lower weight
	"application/openmetrics-text;q=0.4, text/*;q=0.5",
	"application/openmetrics-text;q=0.4, */*;q=0.5",
	"application/openmetrics-text;version=0.0.1", // a version that we do not write
	"application/openmetrics-text;version=2.0.0, text/plain",
	// equal weights, so the format that is named more specifically is chosen
	"text/plain, application/*",
	"application/openmetrics-text-and-more",
	"application/openmetrics-text;q=nonsense",
	"application/openmetrics-text;q=1.5",
	"application/openmetrics-text;q=-1",
	"application/openmetrics-text;q=",
	"x-application/openmetrics-text",
	";;;,,,=;q=,",
};

static const char *const get_open[] = {
	"application/openmetrics-text",
	"application/openmetrics-text; version=1.0.0; charset=utf-8",
	"application/openmetrics-text;version=\"1.0.0\"",
	"APPLICATION/OpenMetrics-Text;VERSION=1.0.0;Q=0.9, text/plain;q=0.1",
	"application/openmetrics-text,text/plain",
	"text/plain ,\tapplication/openmetrics-text",
	// Both weights are equal, so the format that is named more specifically is chosen.
	"application/openmetrics-text;q=0.5, */*;q=0.5",
	"application/*",
	"application/*, text/plain;q=0.999",
	"text/plain;q=0.5, application/openmetrics-text;q=0.501",
	// We do not write this version of text.
	"text/plain;version=1.0.0, application/openmetrics-text;q=0.1",
	// the headers of Prometheus 2 and 3
	("application/openmetrics-text;version=1.0.0;q=0.5,application/openmetrics-text;version=0.0.1;"
     "q=0.4,text/plain;version=0.0.4;q=0.3,*/*;q=0.2"),
	("application/openmetrics-text;version=1.0.0;escaping=allow-utf-8;q=0.6,"
     "application/openmetrics-text;version=0.0.1;q=0.5,text/plain;version=1.0.0;"
     "escaping=allow-utf-8;q=0.4,text/plain;version=0.0.4;q=0.3,*/*;q=0.2"),
};

static void each_header_gets_its_format(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof get_text / sizeof *get_text; i++)
		if (cau_metrics_choose(get_text[i]) != CAU_METRICS_TEXT)
			fail_msg("`%s` got OpenMetrics", get_text[i]);
	for (size_t i = 0; i < sizeof get_open / sizeof *get_open; i++)
		if (cau_metrics_choose(get_open[i]) != CAU_METRICS_OPEN)
			fail_msg("`%s` got text", get_open[i]);
}

static void without_a_header_it_is_text(void **state)
{
	(void)state;
	assert_int_equal(cau_metrics_choose(NULL), CAU_METRICS_TEXT);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_header_gets_its_format),
		cmocka_unit_test(without_a_header_it_is_text),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
