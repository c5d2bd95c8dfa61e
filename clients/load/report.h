// SPDX-License-Identifier: GPL-3.0-or-later
// The results of a run.
#pragma once

#include "load/fleet.h"

typedef struct load_result {
	double window_s, end_s; // length of the measurement; its end on the server's clock
	double realtime_factor_min;
	double steal_pct;      // stolen share of this machine's processor time; NAN if unknown
	double load_cpu_pct;   // processor time of this program, percent of one core
	double rss_per_viewer; // memory of the daemon for each added viewer, bytes; NAN if unknown or
	                       // without added viewers
	double rss_before, rss_after;
	int64_t lost_acknowledged; // negative if the log could not be read
	int64_t acknowledged;
} load_result;

double load_realtime_factor(const load_session *session, double end_s);
void load_report_text(FILE *out, load_fleet *fleet, const load_result *result);
void load_report_json(FILE *out, load_fleet *fleet, const load_result *result);
