// SPDX-License-Identifier: GPL-3.0-or-later
// Reports about the daemon: its load, and the progress of a restart.
#pragma once

#include "agent/agent.h"
#include "config/config.h"
#include "hub/hub.h"

// ---- load ---------------------------------------------------------------------------------------
// Measures the daemon's load, by which a proxy places new sessions.

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

// ---- progress of a restart ----------------------------------------------------------------------
// Reports the progress of resuming the store's sessions, in the log and to systemd (`systemctl
// status`).

typedef struct cau_restart {
	cau_hub *hub;     // borrowed
	int32_t of, left; // of: sessions at the start; left: those that are not resumed yet
	double began_s, told_s;
} cau_restart;

// Begins the reports, once the hub has begun to resume `sessions` sessions. One thread uses this.
void cau_restart_begin(cau_restart *restart, cau_hub *hub, int32_t sessions);
// Reports the progress. Call it now and then, also when all are resumed.
void cau_restart_tell(cau_restart *restart);
