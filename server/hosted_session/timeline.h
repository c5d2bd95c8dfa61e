// SPDX-License-Identifier: GPL-3.0-or-later
// The events of a session, for its timeline, its clients and the store. The newest events of the
// present line are in memory. Older events are read from the store. Only the session's owning
// thread (internal.h) uses this.
#pragma once

#include "hosted_session/record.h"

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
