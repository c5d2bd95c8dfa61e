// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the daemon's load, by which a proxy places new sessions.
#pragma once

#include "agent/load.h"
#include "config/config.h"
#include "hub/hub.h"

typedef struct cau_load_meter {
	const cau_config *config; // borrowed
	cau_hub *hub;
	int32_t worker_count;
	// start of the present window: monotonic time, and processor time by then
	double window_s, window_cpu_s;
	double busy_share; // share of the cores used in the last window
} cau_load_meter;

void cau_load_meter_init(cau_load_meter *meter, const cau_config *config, cau_hub *hub,
                         int32_t worker_count);
// Fills all members except `takes`. One thread uses this.
void cau_load_meter_read(cau_load_meter *meter, cau_load *load);
