// SPDX-License-Identifier: GPL-3.0-or-later
// What happened in a session: its events, and what steps did to the tissue. Only the session's
// owning thread (internal.h) uses this.
#pragma once

#include "cautery/session.h"
#include "hosted_session/record.h"
#include "hosted_session/sink.h"

// ---- events -------------------------------------------------------------------------------------
// The events of a session, for its timeline, its clients and the store. The newest events of the
// present line are in memory. Older events are read from the store.

enum {
	EVENT_COUNT = 512, // most events in memory
	// longest time, in ticks, over which cuts are merged into one event, and so are tears
	CUT_MERGE_TICKS = 30,
};

typedef struct cau_hosted_timeline {
	const cau_present_core *core;                // borrowed
	cau_hosted_record *record;                   // borrowed
	cau_wire_timeline_event events[EVENT_COUNT]; // ring buffer of events of the present line
	uint64_t count;
	bool older;         // the store has events that are older than those in memory
	uint64_t cut_open;  // index + 1 of the unpublished cut event that may still grow; 0: none
	uint64_t tear_open; // index + 1 of the unpublished tear event that may still grow; 0: none
} cau_hosted_timeline;

typedef struct cau_timeline_page {
	cau_wire_timeline_event *events; // newest first while the page is being read
	int32_t count, capacity;
} cau_timeline_page;

void cau_timeline_add(cau_hosted_timeline *timeline, int kind, const char *tool, const char *client,
                      int64_t count, const char *detail);
// Publishes the events that may still grow. Call this before a session rests or is rewound.
void cau_timeline_end_cuts(cau_hosted_timeline *timeline);
void cau_timeline_settle(cau_hosted_timeline *timeline); // call this after each step
// Loads the events of the present branch up to the present tick from the store.
void cau_timeline_load(cau_hosted_timeline *timeline);
// Reads the newest events on the branch's line from `from_tick` to `to_tick`. The oldest of them
// comes first.
cau_status cau_timeline_read(const cau_hosted_identity *identity, int64_t branch,
                             uint64_t from_tick, uint64_t to_tick, cau_timeline_page *taken,
                             cau_error *error);

// ---- findings and faults ------------------------------------------------------------------------
// Reports what steps did to the tissue, and faults. A fault is numerical trouble or a broken safety
// rule, and stops this session alone.

typedef struct cau_hosted_findings {
	int32_t elements_removed, elements_torn;
	uint32_t vessel_flags[CAU_MAX_VESSELS];
	uint32_t inverted_layers;  // one bit for each layer whose inverted tetrahedra were reported
	uint64_t gain_tick;        // tick of the last report that steps gained energy; 0: none
	uint32_t refused_commands; // commands that were refused on arrival or at a tick
} cau_hosted_findings;

// Takes the core's present cuts and vessels as already reported. Call this after a replay or a
// rewind.
void cau_findings_know(cau_hosted_findings *findings, const cau_session *core);
// Reports the findings of a step: cuts, tears, vessels, layers, refused commands.
void cau_findings_note(cau_hosted *h, const cau_frame *frame);

// Faults the session because of numerical trouble outside a step, and notifies all clients.
void cau_hosted_fault(cau_hosted *h, const cau_error *error);
void cau_hosted_tell_fault(cau_hosted *h, const cau_error *error);
// Faults the session because the core would heat decisions.odd_tool, whose energy is off in the
// state machine.
void cau_fault_stop_unsound(cau_hosted *h);
// Reports a broken safety rule of the decisions, once.
void cau_fault_report_broken_rule(cau_hosted *h);
