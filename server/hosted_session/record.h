// SPDX-License-Identifier: GPL-3.0-or-later
// The session's side of the store: one batch a slice, and answers after its commit. The record
// belongs to the thread that has the session; what any thread may see of the commits is apart.
#pragma once

#include <stdatomic.h>

#include "buffer/shelf.h"
#include "hosted_session/history.h"
#include "hosted_session/identity.h"
#include "hosted_session/present_core.h"
#include "log/log.h"

// An answer that waits for its commit.
typedef struct cau_pending {
	struct cau_pending *next;
	cau_reply reply;
	char *text; // malloc'ed
	size_t text_bytes;
} cau_pending;

// Set by the session's thread and by the store's, read by any.
typedef struct cau_hosted_commits {
	// The store lacks commands from this tick on, until a checkpoint is stored; UINT64_MAX: none.
	_Atomic uint64_t lost_from;
	atomic_bool checkpoint_wanted;
	atomic_int under_way; // on their way to the disk
	atomic_int unmade;    // a cau_status: why the store has not taken the session's first entries
} cau_hosted_commits;

typedef struct cau_hosted_record {
	const cau_hosted_identity *identity; // borrowed, like the next three
	const cau_present_core *core;
	const cau_hosted_history *history;
	cau_hosted_commits *commits;

	cau_store_batch *batch; // of this slice; NULL: nothing to write
	uint64_t batch_tick;    // when it was begun
	uint64_t batch_lost;    // a log that is lost from here on ends with this batch's checkpoint
	bool batch_acts;        // it has log entries since its last checkpoint
	cau_pending *pending;   // answers that wait for it
	uint64_t logged_tick;   // of the last log entry
	uint32_t logged_order;  // entries of that tick
	bool logged_acts;       // some of these are commands
	bool touched;           // since the last checkpoint, by commands or cuts
	double checkpoint_s;    // of the last checkpoint
	uint64_t checkpoint_tick;
	int32_t quiet_checkpoints; // in a row, each before which nothing happened
	cau_shelf *shelf;          // memory for checkpoints
} cau_hosted_record;

void cau_record_init(cau_hosted_record *record, const cau_hosted_identity *identity,
                     const cau_present_core *core, const cau_hosted_history *history,
                     cau_hosted_commits *commits);
cau_store_batch *cau_record_batch(cau_hosted_record *record); // of this slice; NULL: no memory
// Whether a command can be logged at this tick. The log of a tick has no gap before an entry, so
// that a restart has capacity for each acknowledged command. After a loss the log starts again at a
// checkpoint. This call makes the checkpoint, unless the core has commands of this tick already:
// then it returns CAU_IO, and a paused session must be stepped first.
cau_status cau_record_check(cau_hosted_record *record, cau_error *error);
// Logs a command that the core has taken, with the answer to its request if `order` has one.
void cau_record_command(cau_hosted_record *record, const cau_command *command,
                        const cau_order *order, const char *text, size_t text_bytes);
// Records an answer that is no command's.
void cau_record_answer(cau_hosted_record *record, const cau_order *order, const char *text,
                       size_t text_bytes);
void cau_record_state(cau_hosted_record *record, int session_state);
void cau_record_checkpoint(cau_hosted_record *record, uint64_t *hash, size_t *bytes);
// Whether a checkpoint is due by the clock, or is wanted. It ends what a restart would have to
// replay: commands, energy, cuts. With nothing to replay each comes twice as late as the one
// before, so a crash takes a session that no client uses back by no more than the time it was left
// alone.
bool cau_record_is_due(cau_hosted_record *record, bool running, bool energy_on, double now_s);
// Lets a restart come back to the tick of now: by an entry of the log, or by a checkpoint.
void cau_record_reached(cau_hosted_record *record);
// Makes a checkpoint if that is due by the ticks since the last one, or the log is not whole. True:
// it did.
bool cau_record_far(cau_hosted_record *record);
// Has the store keep the state of this tick, and its events.
void cau_record_mark(cau_hosted_record *record);
void cau_record_event(cau_hosted_record *record, const cau_wire_timeline_event *event,
                      cau_log_level level);
// Answers once what is recorded so far is on the disk. Takes `text`.
void cau_record_reply(cau_hosted_record *record, const cau_reply *reply, char *text,
                      size_t text_bytes);
// The store refused something of this tick: the log has a gap here.
void cau_record_gap(cau_hosted_record *record, const cau_error *error);
// A log that lacks something is whole again from the next checkpoint on. Any thread.
void cau_commits_lose(cau_hosted_commits *commits, uint64_t from_tick);
// Submits the slice's batch (commit.c).
void cau_record_commit(cau_hosted *h);
// Looks whether the order was sent before; answers it if so (commit.c).
cau_outcome_kind cau_record_resend(cau_hosted *h, cau_order *order);
