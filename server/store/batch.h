// SPDX-License-Identifier: GPL-3.0-or-later
// The records in a batch, and how they are written into the database.
#pragma once

#include <sqlite3.h>

#include "store/store.h"

// ---- records ------------------------------------------------------------------------------------
// Each record is one allocation with copies of everything that its public struct points to, except
// a checkpoint's snapshot.

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

// ---- writing ------------------------------------------------------------------------------------
// Writes records into the database, inside a transaction of the caller.

enum {
	CAU_STORE_STATEMENTS = 20,
	// number of slots: about as many as branches that are written at the same time
	CAU_STORE_UNCOUNTED_SLOTS = 16,
};

// Bytes of commands that branches.bytes does not count yet. Counting with each command would write
// the table page of branches with each commit. A crash loses these bytes, less than a page for each
// branch.
struct cau_store_uncounted {
	struct {
		int64_t key, branch, bytes; // bytes 0 means that the slot is free
	} slot[CAU_STORE_UNCOUNTED_SLOTS];
};

struct cau_store_writer {
	sqlite3 *database; // borrowed
	sqlite3_stmt *statement[CAU_STORE_STATEMENTS];
	// A rollback restores the value from before the records that it undoes.
	struct cau_store_uncounted uncounted;
};

// Compiles every statement. This also checks that the tables are as this build expects.
cau_status cau_store_writer_init(struct cau_store_writer *writer, sqlite3 *database,
                                 cau_error *error);
// the writer may be zeroed or initialised
void cau_store_writer_finish(struct cau_store_writer *writer);

// Writes one record. CAU_ALREADY_EXISTS and CAU_NOT_FOUND are the record's own errors; any other
// error is the disk's.
cau_status cau_store_writer_apply(struct cau_store_writer *writer, const struct record *record,
                                  int64_t now_ms, cau_error *error);

// ---- writing the records of sessions that move (moves.c) ----------------------------------------
// Writes the records of sessions that move, inside a transaction of the caller. Moves are rare, so
// the statements are compiled when they are needed.

// Writes one record. CAU_ALREADY_EXISTS, CAU_NOT_FOUND and CAU_BAD_VALUE are the record's own
// errors; any other error is the disk's.
cau_status cau_store_import(sqlite3 *database, const struct record *record, int64_t now_ms,
                            cau_error *error);
