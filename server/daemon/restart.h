// SPDX-License-Identifier: GPL-3.0-or-later
// Reports the progress of resuming the store's sessions, in the log and to systemd (`systemctl
// status`).
#pragma once

#include "hub/hub.h"

typedef struct cau_restart {
	cau_hub *hub;     // borrowed
	int32_t of, left; // of: sessions at the start; left: those that are not resumed yet
	double began_s, told_s;
} cau_restart;

// Begins the reports, once the hub has begun to resume `sessions` sessions. One thread uses this.
void cau_restart_begin(cau_restart *restart, cau_hub *hub, int32_t sessions);
// Reports the progress. Call it now and then, also when all are resumed.
void cau_restart_tell(cau_restart *restart);
