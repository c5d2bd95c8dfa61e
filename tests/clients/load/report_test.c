// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/load.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double rounding = 1e-12; // largest error of a quotient of doubles

static void the_factor_is_simulated_over_wall_time(void **state)
{
	(void)state;
	load_session session = {.has_first = true, .first = {5, 100}, .last = {14, 110}};
	assert_true(fabs(load_realtime_factor(&session, 110.1) - 0.9) < rounding);
}

static void silence_at_the_end_counts(void **state)
{
	(void)state;
	load_session session = {.has_first = true, .first = {5, 100}, .last = {10, 105}};
	assert_true(fabs(load_realtime_factor(&session, 110) - 0.5) < rounding);
}

static void without_frames_nothing_was_simulated(void **state)
{
	(void)state;
	load_session session = {0};
	assert_true(load_realtime_factor(&session, 110) == 0);
}

static void json_has_every_figure_and_null_for_the_unknown(void **state)
{
	(void)state;
	static const char *const fields[] = {
		"realtime_factor_min", "steal_pct",         "frame_ms",
		"command_ms",          "bytes_per_vertex",  "decode_errors",
		"gaps_unrecovered",    "lost_acknowledged", "rss_per_viewer",
	};
	char *text = NULL;
	size_t bytes = 0;
	load_options options = {.scene = "fascia", .sessions = 1, .viewers = 1};
	load_fleet fleet = {.options = &options, .moved = 10, .position_bytes = 16};
	load_result result = {.rss_per_viewer = NAN, .lost_acknowledged = -1, .realtime_factor_min = 1};
	load_samples_add(&fleet.frame_ms, 2);
	FILE *out = open_memstream(&text, &bytes);
	load_report_json(out, &fleet, &result);
	fclose(out);
	for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
		if (!strstr(text, fields[i]))
			fail_msg("no %s in %s", fields[i], text);
	assert_non_null(strstr(text, "\"rss_per_viewer\":null"));
	assert_non_null(strstr(text, "\"lost_acknowledged\":null"));
	assert_non_null(strstr(text, "\"bytes_per_vertex\":1.6"));
	assert_non_null(strstr(text, "\"frame_ms\":{\"p50\":2,\"p99\":2,\"max\":2,\"count\":1}"));
	assert_non_null(strstr(text, "\"command_ms\":{\"p50\":null"));
	free(text);
	load_samples_finish(&fleet.frame_ms);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_factor_is_simulated_over_wall_time),
		cmocka_unit_test(silence_at_the_end_counts),
		cmocka_unit_test(without_frames_nothing_was_simulated),
		cmocka_unit_test(json_has_every_figure_and_null_for_the_unknown),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
