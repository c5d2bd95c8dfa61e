// SPDX-License-Identifier: GPL-3.0-or-later
// Tells how far a daemon is with the sessions of its store: in the log, and to systemd, whose
// `systemctl status` shows it.
#pragma once

#include "hub/hub.h"

typedef struct cau_restart {
	cau_hub *hub;     // borrowed
	int32_t of, left; // sessions that it began with, and those that are not there yet
	double began_s, told_s;
} cau_restart;

// Once the hub has taken up so many of the store. One thread.
void cau_restart_begin(cau_restart *restart, cau_hub *hub, int32_t sessions);
// Now and then, until it is done and after.
void cau_restart_tell(cau_restart *restart);
