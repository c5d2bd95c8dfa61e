// SPDX-License-Identifier: GPL-3.0-or-later
// How much room a daemon has for new sessions, as a proxy in front of several is told.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct cau_load {
	bool takes; // new sessions; false: it starts, drains, stands aside, or its store has no room
	int32_t session_count, session_count_most;
	int64_t session_bytes, session_bytes_most; // memory of all sessions, about
	double busy_share;     // of the workers' cores that the process was running on, 0 to 1
	double pace_share_min; // of its speed that the session furthest behind reaches, 0 to 1
} cau_load;

// The least of the free shares of sessions, memory and cores, times the share of its speed that the
// session furthest behind reaches: 1 to 100 %. Never 0, which HAProxy takes for `drain`: where all
// daemons are full one of them has to say so.
int cau_load_free_percent(const cau_load *load);

enum { CAU_LOAD_LINE_BYTES = 16 };

// The line of HAProxy's agent-check: "ready 63%\n" or "drain\n". Returns its bytes.
size_t cau_load_write(const cau_load *load, char line[CAU_LOAD_LINE_BYTES]);
