// SPDX-License-Identifier: GPL-3.0-or-later
// A trace: all calls of a session's machine (cau_logic) and its answers, in order, as text. Each
// call is one line; below it, indented by two spaces, are its results:
//
//     take time_s=0x1.8p+9 event=order ask=energy_on ticket=7 asker.client=2 tool="hook" ...
//       effect=wake
//     next time_s=0x1.81p+9
//       act=order ticket=7 drive.tool="hook" drive.driver.client=2 ...
//     done time_s=0x1.82p+9 outcome=done
//       effect=tell drive.tool="hook" drive.energized=1 ...
//
// Members that are zero, false or empty are omitted. Reals are hexadecimal, so that reading gives
// the same value. The machine is deterministic, so the same calls must give the same answers.
#pragma once

#include <stdio.h>

#include "session/logic.h"

typedef enum cau_trace_what {
	CAU_TRACE_INIT,    // arguments: capacity, step_s of a new machine
	CAU_TRACE_TAKE,    // arguments: the event and its members
	CAU_TRACE_NEXT,    // argument: time_s
	CAU_TRACE_DONE,    // arguments: time_s, outcome
	CAU_TRACE_STEPPED, // arguments: time_s, faulted, cause
	CAU_TRACE_WHAT_COUNT
} cau_trace_what;

// A call of the machine with all its arguments, without pointers to other memory.
typedef struct cau_trace_call {
	cau_trace_what what;
	double time_s, alive_s;
	int32_t capacity;
	double step_s;
	cau_logic_event_kind event;
	uint32_t client;
	uint64_t number;
	char subject[CAU_NAME_BYTES]; // tool of the event
	char cause[320];              // cause of an event, or of a step's fault
	bool store_takes;
	int state;
	uint64_t tick;
	cau_asked asked;
	cau_arrived_tool tools[CAU_MAX_TOOLS];
	int32_t tool_count;
	cau_outcome_kind outcome;
	bool faulted;
} cau_trace_call;

// ---- writing; the caller holds the machine's lock

// In all these functions `to` may be NULL; then nothing is written. A failed write shows in
// ferror(to).
void cau_trace_init(FILE *to, int32_t capacity, double step_s);
void cau_trace_take(FILE *to, const cau_logic_event *event);
void cau_trace_next(FILE *to, double now_s);
void cau_trace_done(FILE *to, double now_s, cau_outcome_kind outcome);
void cau_trace_stepped(FILE *to, double now_s, const char *fault); // NULL if it succeeded
// Write the results of the last call.
void cau_trace_action(FILE *to, const cau_action *action);
void cau_trace_effects(FILE *to, const cau_effects *effects);

// ---- reading

// Reads a line that is not indented. CAU_BAD_SYNTAX: error->reason says which part has no meaning.
cau_status cau_trace_read(const char *line, cau_trace_call *call, cau_error *error);
// Writes a call's line in the form that cau_trace_read reads.
void cau_trace_write(FILE *to, const cau_trace_call *call);

typedef struct cau_trace_counts {
	uint64_t events, acts, effects; // acts: without CAU_ACT_NOTHING
	uint64_t of_event[CAU_LOGIC_EVENT_COUNT];
} cau_trace_counts;

// Repeats all calls of a trace on a new machine and compares its answers, to the last letter. A
// last call that is incomplete, because the daemon was killed, is ignored. CAU_CORRUPT: at the line
// in error->path ("line 12") the machine answers differently; error->reason has both answers.
// CAU_BAD_SYNTAX: that line is not a line of a trace. CAU_NO_MEMORY.
cau_status cau_trace_replay(FILE *trace, cau_trace_counts *counts, cau_error *error);
