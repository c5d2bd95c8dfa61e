// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of a run.
#pragma once

#include "load/fleet.h"

typedef struct load_result {
	double window_s, end_s; // measured; end on the server's clock
	double realtime_factor_min;
	double steal_pct;      // of this machine's processor time; NAN: unknown
	double load_cpu_pct;   // of one core, used by this program
	double rss_per_viewer; // B; NAN: unknown or nobody was added
	double rss_before, rss_after;
	int64_t lost_acknowledged; // below 0: the log could not be read
	int64_t acknowledged;
} load_result;

double load_realtime_factor(const load_session *session, double end_s);
void load_report_text(FILE *out, load_fleet *fleet, const load_result *result);
void load_report_json(FILE *out, load_fleet *fleet, const load_result *result);
