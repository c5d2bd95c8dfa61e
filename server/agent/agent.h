// SPDX-License-Identifier: GPL-3.0-or-later
// HAProxy's TCP agent-check: whoever connects gets one line and is closed. Nothing is read of a
// peer and nobody is waited for, so that a bad one costs what a good one does.
#pragma once

#include <stddef.h>

#include "agent/load.h"
#include "cautery/status.h"

typedef struct cau_agent cau_agent;

// `measure` says what the load is now; it is called on the agent's thread, at most every
// CAU_AGENT_MEASURE_S, whoever asks how often.
#define CAU_AGENT_MEASURE_S 0.25
typedef struct cau_agent_def {
	const char *address; // a numeric one or a host's name
	int port;            // 0: any free one
	void (*measure)(void *user, cau_load *load);
	void *user;
} cau_agent_def;

// Listens and starts its thread. Errors: CAU_IO (it cannot listen there), CAU_NO_MEMORY.
cau_status cau_agent_create(cau_agent **agent, const cau_agent_def *def, cau_error *error);
int cau_agent_port(const cau_agent *agent);
void cau_agent_destroy(cau_agent *agent); // takes NULL
