// SPDX-License-Identifier: GPL-3.0-or-later
// The records in a batch. Each record is one allocation with copies of everything that its public
// struct points to, except a checkpoint's snapshot.
#pragma once

#include "store/store.h"

enum record_kind {
	RECORD_SESSION,
	RECORD_SESSION_STATE,  // as.session: only id and state are set
	RECORD_SESSION_DELETE, // as.session: only id is set
	RECORD_COMMAND,
	RECORD_ANSWER,
	RECORD_CHECKPOINT,
	RECORD_EVENT,
	RECORD_EVENTS_FORGET, // as.event: only session, branch and tick are set
	RECORD_BRANCH,
	RECORD_MARK, // as.gap: only session, branch and from_tick are set
	RECORD_GAP,
	RECORD_MOVED,
	RECORD_ARRIVAL,
	RECORD_ARRIVAL_FORGET, // as.arrival: only id is set
	RECORD_ROWS,           // as.rows; the bytes are lent
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
	} as; // pointers lead into `storage` or to `lent`
	void *lent;
	void (*give_back)(void *lent); // NULL if nothing is lent
	unsigned char storage[];
};

struct cau_store_batch {
	struct record *first, *last;
	size_t bytes;
	uint64_t record_count;

	// The members from here on are set by submit and by the commit.
	struct cau_store_batch *next;
	cau_store_callback callback;
	void *user;
	double submitted_s; // monotonic time of the submission, s
	cau_error error;    // result of the batch's commit
};

// Returns the client and sequence of the request that the record answers. Returns false if the
// record answers no request.
bool cau_store_record_request(const struct record *record, const char **client, uint64_t *sequence);
