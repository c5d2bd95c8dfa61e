// SPDX-License-Identifier: GPL-3.0-or-later
// The load of a daemon, as an answer to a proxy in front of several daemons.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

// ---- load ---------------------------------------------------------------------------------------
// Computes how many more sessions the daemon can take.

typedef struct cau_load {
	// accepts new sessions; false while the daemon starts, drains or stands aside, or if its store
	// is not ready
	bool takes;
	int32_t session_count, session_count_most;
	int64_t session_bytes, session_bytes_most; // approximate memory of all sessions
	double busy_share;                         // used share of the workers' cores, 0 to 1
	double pace_share_min; // pace of the slowest session, as a share of its speed, 0 to 1
} cau_load;

// Returns the free capacity, 1 to 100 %: the least of the free shares of sessions, memory and
// cores, times pace_share_min. The result is never 0, because HAProxy treats 0 as `drain`. If all
// daemons are full, the proxy must still send new sessions to one of them, which reports the error.
int cau_load_free_percent(const cau_load *load);

enum { CAU_LOAD_LINE_BYTES = 16 };

// Writes the line of HAProxy's agent-check: "ready 63%\n" or "drain\n". Returns its bytes.
size_t cau_load_write(const cau_load *load, char line[CAU_LOAD_LINE_BYTES]);

// ---- agent --------------------------------------------------------------------------------------
// HAProxy's TCP agent-check: each connection gets one line and is closed. The agent reads nothing
// and waits for no peer, so a bad peer costs no more than a good one.

typedef struct cau_agent cau_agent;

// `measure` returns the present load. It is called on the agent's thread, at most once in
// CAU_AGENT_MEASURE_S, however many peers ask.
#define CAU_AGENT_MEASURE_S 0.25
typedef struct cau_agent_def {
	const char *address; // a numeric address or a host name
	int port;            // 0: any free port
	void (*measure)(void *user, cau_load *load);
	void *user;
} cau_agent_def;

// Listens and starts the thread. Errors: CAU_IO (cannot listen at the address), CAU_NO_MEMORY.
cau_status cau_agent_create(cau_agent **agent, const cau_agent_def *def, cau_error *error);
int cau_agent_port(const cau_agent *agent);
void cau_agent_destroy(cau_agent *agent); // `agent` may be NULL
