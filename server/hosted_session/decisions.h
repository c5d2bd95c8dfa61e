// SPDX-License-Identifier: GPL-3.0-or-later
// The decisions about a session, and the notices to clients about drivers and energy.
#pragma once

#include <pthread.h>
#include <stdio.h>

#include "hosted_session/life.h"

// ---- decisions ----------------------------------------------------------------------------------
// The decisions about a session: the state machine of server/session under a lock. The lock is held
// briefly, never while the core computes, and never inside another lock of the session. Clients are
// notified of decisions under the lock, so in the order of the decisions.

typedef struct cau_hosted_decisions {
	pthread_mutex_t lock;
	cau_logic *logic;   // the state machine; its tickets are pointers to orders
	FILE *trace;        // trace of the calls of `logic`; NULL: no trace
	bool rule_reported; // a broken safety rule was reported
	// Only the worker uses this: a tool that the core would heat in this step although its energy
	// is off in `logic`; "": none.
	char odd_tool[CAU_NAME_BYTES];
} cau_hosted_decisions;

// A copy of all decided values except the queue.
typedef struct cau_decided {
	int state;
	double speed;
	double tick_s;   // in a running session: start of the next tick, s on the monotonic clock
	double period_s; // time between the starts of two ticks, s on the monotonic clock
	int64_t steps_left;
	uint32_t lockstep; // number of the client that has the session in lock-step; 0: none
	int32_t drive_count;
	char fault[sizeof((cau_logic *)0)->fault];
} cau_decided;

// `logic` has memory for `orders` orders (cau_logic_bytes). cau_decisions_finish frees `logic`.
void cau_decisions_init(cau_hosted_decisions *decisions, int32_t orders, double step_s);
void cau_decisions_finish(cau_hosted_decisions *decisions);
// Opens the trace if the settings ask for one. Call this before the first decision.
void cau_decisions_open_trace(cau_hosted_decisions *decisions, const cau_hosted_identity *identity);
// call this after each slice
void cau_decisions_flush_trace(cau_hosted_decisions *decisions, const char *id);

// ---- copies of the decisions, for any thread

// Returns a CAU_SESSION_* state. Any thread whose event breaks a safety rule changes the state to
// CAU_SESSION_FAULTED.
int cau_decisions_state(cau_hosted_decisions *decisions);
cau_decided cau_decisions_now(cau_hosted_decisions *decisions);
// Returns the time at which the worker next has something to do other than ticks.
double cau_decisions_due_s(cau_hosted_decisions *decisions);
// Returns the time at which drivers must next be checked for silence; INFINITY if no energy is on.
double cau_decisions_look_s(cau_hosted_decisions *decisions);
// Copies the drive of one tool. Returns false if the tool has no drive.
bool cau_decisions_find(cau_hosted_decisions *decisions, const char *tool, cau_drive *drive);
// Copies the drives of all tools, at most CAU_MAX_TOOLS. Returns their number.
int32_t cau_decisions_drives(cau_hosted_decisions *decisions, cau_drive *drives);
// Returns true once, at the first call after a safety rule was broken. `reason` holds 320 bytes.
bool cau_decisions_broken(cau_hosted_decisions *decisions, char *reason, size_t bytes);

// ---- effects.c: events from any thread, and the worker's next act
// These functions may wake the session, answer orders and notify clients. So they take the whole
// session.

// Handles one event and carries out its effects. Effects that are acts of the worker wait for
// cau_decide_next.
void cau_decide(cau_hosted *h, const cau_logic_event *event);
// Handles an order as an event. Takes ownership of the order if the result is CAU_OK.
cau_status cau_decide_order(cau_hosted *h, cau_order *order, const cau_asked *asked,
                            cau_error *error);
// Writes the worker's next act to *action. Before CAU_ACT_STEP, decisions.odd_tool is "" if the
// core heats exactly the tools whose energy is on in `logic`.
void cau_decide_next(cau_hosted *h, cau_action *action);
// Reports the outcome of the act.
void cau_decide_done(cau_hosted *h, cau_outcome_kind outcome);
void cau_decide_stepped(cau_hosted *h, const char *fault);
// Reports that the core has a new state with these tools, after a start, rewind, reset or restore.
void cau_decide_arrived(cau_hosted *h, int state, const char *cause);
// Answers an energy-off or a pause whose command cannot be stored, and frees the order. The command
// takes effect at the next tick border, but the log does not contain it.
void cau_hosted_answer_unstored(cau_hosted *h, cau_order *order);

// ---- notices of drivers, energy and refused motion ----------------------------------------------
// Notifies clients of drivers and energy. Also counts refused motion for each tool and reports the
// count to the client that sent it, once a second.

// Refused motion of one tool.
typedef struct cau_refused_motion {
	char tool[CAU_NAME_BYTES]; // "": the entry is unused
	int64_t count;
	double told_s;
	uint32_t client;
	uint64_t sequence; // sequence number of the newest refused motion
	cau_error error;
} cau_refused_motion;

// Refused motion of all tools of a session. Any thread may use this struct, under the lock.
typedef struct cau_hosted_refusals {
	pthread_mutex_t lock;
	uint64_t count; // refused motions of all tools since the session was created
	cau_refused_motion place[CAU_MAX_TOOLS];
} cau_hosted_refusals;

void cau_refusals_note(cau_hosted_refusals *refusals, const cau_order *order,
                       const cau_error *error);
void cau_refusals_report(cau_hosted_refusals *refusals, const cau_hosted_identity *identity,
                         double now_s); // reports each tool at most once a second

// Sends tool.driver_changed.
void cau_driver_notify(const cau_hosted_identity *identity, const cau_drive *drive);
