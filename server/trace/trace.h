// SPDX-License-Identifier: GPL-3.0-or-later
// A trace: everything that a session's machine was told, and what it answered, in the order in
// which it happened. A line a call, in words, and below it, set in by two spaces, what came of it:
//
//     take time_s=0x1.8p+9 event=order ask=energy_on ticket=7 asker.client=2 tool="hook" ...
//       effect=wake
//     next time_s=0x1.81p+9
//       act=order ticket=7 drive.tool="hook" drive.driver.client=2 ...
//     done time_s=0x1.82p+9 outcome=done
//       effect=tell drive.tool="hook" drive.lit=1 ...
//
// What is zero, false or empty is left out; reals are hexadecimal, so that they read back the same.
// The machine is all that decides, so a machine that takes the same calls again must say the same.
#pragma once

#include <stdio.h>

#include "session/logic.h"

typedef enum cau_trace_what {
	CAU_TRACE_INIT,    // capacity, step_s: the machine is new
	CAU_TRACE_TAKE,    // event and what belongs to it
	CAU_TRACE_NEXT,    // time_s
	CAU_TRACE_DONE,    // time_s, outcome
	CAU_TRACE_STEPPED, // time_s, faulted, cause
	CAU_TRACE_WHAT_COUNT
} cau_trace_what;

// A call of the machine with all that it was given, and without a pointer out of it.
typedef struct cau_trace_call {
	cau_trace_what what;
	double time_s, alive_s;
	int32_t capacity;
	double step_s;
	cau_logic_event_kind event;
	uint32_t client;
	uint64_t number;
	char subject[CAU_NAME_BYTES]; // the event's tool
	char cause[320];              // of an event, or a step's fault
	bool store_takes;
	int state;
	uint64_t tick;
	cau_asked asked;
	cau_arrived_tool tools[CAU_MAX_TOOLS];
	int32_t tool_count;
	cau_outcome_kind outcome;
	bool faulted;
} cau_trace_call;

// ---- writing; whoever holds the machine's lock
// ----------------------------------------------------

// `to` may be NULL wherever these are called: nothing is written then. A write that fails shows in
// ferror(to).
void cau_trace_init(FILE *to, int32_t capacity, double step_s);
void cau_trace_take(FILE *to, const cau_logic_event *event);
void cau_trace_next(FILE *to, double now_s);
void cau_trace_done(FILE *to, double now_s, cau_outcome_kind outcome);
void cau_trace_stepped(FILE *to, double now_s, const char *fault); // NULL: it went well
// What came of the call before it.
void cau_trace_action(FILE *to, const cau_action *action);
void cau_trace_effects(FILE *to, const cau_effects *effects);

// ---- reading
// --------------------------------------------------------------------------------------

// Reads a line that is not set in. CAU_BAD_SYNTAX: error->reason says what of it has no meaning.
cau_status cau_trace_read(const char *line, cau_trace_call *call, cau_error *error);
// The call's line, as it is read.
void cau_trace_write(FILE *to, const cau_trace_call *call);

typedef struct cau_trace_counts {
	uint64_t events, acts, effects; // acts: without those that are nothing
	uint64_t of_event[CAU_LOGIC_EVENT_COUNT];
} cau_trace_counts;

// Tells a machine everything again and compares what it answers, to the last letter. A last call
// that was not written whole, as of a daemon that was killed, is left out. CAU_CORRUPT: error->path
// is the line ("line 12") where it answers otherwise, error->reason both answers; CAU_BAD_SYNTAX:
// that line is none of a trace; CAU_NO_MEMORY.
cau_status cau_trace_replay(FILE *trace, cau_trace_counts *counts, cau_error *error);
