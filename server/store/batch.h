// SPDX-License-Identifier: GPL-3.0-or-later
// What a batch holds: records, each one allocation with copies of all that its public struct points
// to, but for a checkpoint's snapshot.
#pragma once

#include "store/store.h"

enum record_kind {
	RECORD_SESSION,
	RECORD_SESSION_STATE,  // as.session: id, state
	RECORD_SESSION_DELETE, // as.session: id
	RECORD_COMMAND,
	RECORD_ANSWER,
	RECORD_CHECKPOINT,
	RECORD_EVENT,
	RECORD_EVENTS_FORGET, // as.event: session, branch, tick
	RECORD_BRANCH,
	RECORD_MARK, // as.gap: session, branch, from_tick
	RECORD_GAP,
	RECORD_MOVED,
	RECORD_ARRIVAL,
	RECORD_ARRIVAL_FORGET, // as.arrival: id
	RECORD_ROWS,           // as.rows; what is lent
	RECORD_GENERATION,     // as.generation
};

struct record {
	struct record *next;
	enum record_kind kind;
	union {
		cau_store_session session;
		cau_store_command command;
		cau_store_answer answer;
		cau_store_checkpoint checkpoint;
		cau_store_event event;
		cau_store_branch branch;
		cau_store_gap gap;
		cau_store_moved moved;
		cau_store_arrival arrival;
		struct {
			const char *id;
			cau_store_bytes piece;
		} rows;
		const char *generation;
	} as; // its pointers lead into storage, or to what is lent
	void *lent;
	void (*give_back)(void *lent); // NULL: nothing is lent
	unsigned char storage[];
};

struct cau_store_batch {
	struct record *first, *last;
	size_t bytes;
	uint64_t record_count;

	// Set by submit and by the commit.
	struct cau_store_batch *next;
	cau_store_callback callback;
	void *user;
	double submitted_s; // monotonic
	cau_error error;    // how its commit ended
};

// The client's request that the record answers. False if it answers none.
bool cau_store_record_request(const struct record *record, const char **client, uint64_t *sequence);
