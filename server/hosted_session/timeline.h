// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, for the timeline, for all clients of the session, and for the store. The newest
// events of the present line are in memory; older ones are read from the store. It belongs to the
// thread that has the session.
#pragma once

#include "hosted_session/record.h"

enum {
	EVENT_COUNT = 512,    // kept in memory
	CUT_MERGE_TICKS = 30, // cuts of neighbouring ticks are one event, and so are tears
};

typedef struct cau_hosted_timeline {
	const cau_present_core *core;                // borrowed
	cau_hosted_record *record;                   // borrowed
	cau_wire_timeline_event events[EVENT_COUNT]; // ring, of the present line
	uint64_t count;
	bool older;         // the store has some from before
	uint64_t cut_open;  // the event, and 1, that may grow and is not published yet; 0: none
	uint64_t tear_open; // the same of tears
} cau_hosted_timeline;

typedef struct cau_timeline_page {
	cau_wire_timeline_event *events; // newest first while it is read
	int32_t count, capacity;
} cau_timeline_page;

void cau_timeline_add(cau_hosted_timeline *timeline, int kind, const char *tool, const char *client,
                      int64_t count, const char *detail);
// Publishes what may grow: before a session rests or is rewound.
void cau_timeline_end_cuts(cau_hosted_timeline *timeline);
void cau_timeline_settle(cau_hosted_timeline *timeline); // after each step
// From the store: of the present branch up to the tick.
void cau_timeline_load(cau_hosted_timeline *timeline);
// The newest on the branch's line from `from_tick` up to `to_tick`, the oldest of them first.
cau_status cau_timeline_read(const cau_hosted_identity *identity, int64_t branch,
                             uint64_t from_tick, uint64_t to_tick, cau_timeline_page *taken,
                             cau_error *error);
