// SPDX-License-Identifier: GPL-3.0-or-later
// HAProxy's TCP agent-check: each connection gets one line and is closed. The agent reads nothing
// and waits for no peer, so a bad peer costs no more than a good one.
#pragma once

#include <stddef.h>

#include "agent/load.h"
#include "cautery/status.h"

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
