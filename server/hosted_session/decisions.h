// SPDX-License-Identifier: GPL-3.0-or-later
// What is decided of a session. The lock is held for moments, never across the core, and inside no
// other lock of the session. Clients are notified of a decision under it, in the decisions' order.
#pragma once

#include <pthread.h>
#include <stdio.h>

#include "hosted_session/identity.h"

typedef struct cau_hosted_decisions {
	pthread_mutex_t lock;
	cau_logic *logic;   // orders are its tickets
	FILE *trace;        // of its calls; NULL: none is wanted
	bool rule_reported; // that a safety rule was broken
	// The worker's: a tool that the core would heat in this step and the machine does not; "":
	// none.
	char odd_tool[CAU_NAME_BYTES];
} cau_hosted_decisions;

// A copy of all that is decided but for the queue.
typedef struct cau_decided {
	int state;
	double speed;
	double tick_s;   // of a running session: when its next tick begins, on the monotonic clock
	double period_s; // from tick to tick, by that clock
	int64_t steps_left;
	uint32_t lockstep; // its client; 0: none
	int32_t drive_count;
	char fault[sizeof((cau_logic *)0)->fault];
} cau_decided;

// `logic` has memory for so many orders, cau_logic_bytes; it is freed at the end.
void cau_decisions_init(cau_hosted_decisions *decisions, int32_t orders, double step_s);
void cau_decisions_finish(cau_hosted_decisions *decisions);
// Opens the trace, where one is wanted; before anything is decided.
void cau_decisions_open_trace(cau_hosted_decisions *decisions, const cau_hosted_identity *identity);
void cau_decisions_flush_trace(cau_hosted_decisions *decisions, const char *id); // after a slice

// ---- decisions, as any thread may read them

// CAU_SESSION_*. Any thread whose event breaks a safety rule makes it CAU_SESSION_FAULTED.
int cau_decisions_state(cau_hosted_decisions *decisions);
cau_decided cau_decisions_now(cau_hosted_decisions *decisions);
// When the worker has something to do, but for ticks.
double cau_decisions_due_s(cau_hosted_decisions *decisions);
// When a silence of a driver is to be looked for; INFINITY: nothing is energized.
double cau_decisions_look_s(cau_hosted_decisions *decisions);
// A copy of a tool's drive. False: there is none.
bool cau_decisions_find(cau_hosted_decisions *decisions, const char *tool, cau_drive *drive);
// Copies of all, at most CAU_MAX_TOOLS.
int32_t cau_decisions_drives(cau_hosted_decisions *decisions, cau_drive *drives);
// Whether a safety rule was broken, the first time that this is asked. `reason`: 320 bytes.
bool cau_decisions_broken(cau_hosted_decisions *decisions, char *reason, size_t bytes);

// ---- effects.c: events of any thread, and the worker's next act. These may wake the session,
// answer orders and notify clients, so they take all of it.

// Takes one event, and carries out its effects, except those of the worker.
void cau_decide(cau_hosted *h, const cau_logic_event *event);
// The same for an order, which is taken on CAU_OK.
cau_status cau_decide_order(cau_hosted *h, cau_order *order, const cau_asked *asked,
                            cau_error *error);
// What the worker is to do now. Of CAU_ACT_STEP: decisions.odd_tool is "" if the core heats what
// the machine has on, and nothing else.
void cau_decide_next(cau_hosted *h, cau_action *action);
// What came of it.
void cau_decide_done(cau_hosted *h, cau_outcome_kind outcome);
void cau_decide_stepped(cau_hosted *h, const char *fault);
// The core is at a state with these tools: after a start, rewind, reset or restore.
void cau_decide_arrived(cau_hosted *h, int state, const char *cause);
// Answers an off or a pause, and frees it. It acts at the next tick border, whatever the store
// says; the log will not show it.
void cau_hosted_answer_unstored(cau_hosted *h, cau_order *order);
