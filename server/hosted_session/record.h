// SPDX-License-Identifier: GPL-3.0-or-later
// The stored past of a session: its branches and named snapshots, its writes to the store, and the
// replay of its log.
#pragma once

#include <stdatomic.h>

#include "buffer/buffer.h"
#include "hosted_session/life.h"
#include "log/log.h"

// ---- branches and named snapshots (history.c) ---------------------------------------------------
// The branches and the named snapshots of a session. Only the session's owning thread (internal.h)
// uses them.

enum { SNAPSHOT_COUNT = 64 };

typedef struct cau_named_snapshot {
	char name[CAU_NAME_BYTES];
	int64_t branch;
	uint64_t tick;
} cau_named_snapshot;

typedef struct cau_hosted_history {
	int64_t branch, next_branch;
	uint64_t first_tick;
	cau_named_snapshot snapshots[SNAPSHOT_COUNT];
	int32_t snapshot_count;
} cau_hosted_history;

const cau_named_snapshot *cau_history_find(const cau_hosted_history *history, const char *name);
// Reads the branches and the snapshots of a session from the store.
cau_status cau_history_load(cau_hosted_history *history, const cau_hosted_identity *identity,
                            cau_error *error);

// ---- writes -------------------------------------------------------------------------------------
// A session's writes to the store: one batch for each slice, and answers after its commit. Only
// the session's owning thread (internal.h) uses the record. Any thread may read cau_hosted_commits.

// An answer that waits for its commit.
typedef struct cau_pending {
	struct cau_pending *next;
	cau_reply reply;
	char *text; // malloc'ed
	size_t text_bytes;
} cau_pending;

// The commits of a session. The session's owning thread and the store's thread set these members,
// and any thread may read them.
typedef struct cau_hosted_commits {
	// The store lacks commands from this tick on, until a checkpoint is stored; UINT64_MAX: it
	// lacks none.
	_Atomic uint64_t lost_from;
	atomic_bool checkpoint_wanted;
	atomic_int under_way; // batches that are not on the disk yet
	atomic_int unmade;    // a cau_status: why the store rejected the session's first rows
} cau_hosted_commits;

typedef struct cau_hosted_record {
	const cau_hosted_identity *identity; // borrowed, as are the next three members
	const cau_present_core *core;
	const cau_hosted_history *history;
	cau_hosted_commits *commits;

	cau_store_batch *batch; // batch of this slice; NULL: nothing to write
	uint64_t batch_tick;    // tick at which `batch` was created
	uint64_t batch_lost;  // first tick of the gap that this batch ends; UINT64_MAX: there is no gap
	bool batch_acts;      // `batch` has log entries since its last checkpoint
	cau_pending *pending; // answers that wait for the commit of `batch`
	uint64_t logged_tick; // tick of the last log entry
	uint32_t logged_order; // number of that tick's next log entry
	bool logged_acts;      // commands are among the log entries of `logged_tick`
	bool touched;          // commands or cuts came since the last checkpoint
	double checkpoint_s;   // time of the last checkpoint
	uint64_t checkpoint_tick;
	int32_t quiet_checkpoints; // consecutive checkpoints between which nothing happened
	cau_shelf *shelf;          // memory for checkpoints
} cau_hosted_record;

void cau_record_init(cau_hosted_record *record, const cau_hosted_identity *identity,
                     const cau_present_core *core, const cau_hosted_history *history,
                     cau_hosted_commits *commits);
// returns the batch of this slice; NULL: no memory
cau_store_batch *cau_record_batch(cau_hosted_record *record);
// Checks whether a command can be logged at this tick. The log of a tick has no gap before an
// entry, so a restart can replay each acknowledged command. After a loss the log starts again at a
// checkpoint. This call makes the checkpoint, unless the core has commands of this tick already. In
// that case it returns CAU_IO, and a paused session must be stepped first.
cau_status cau_record_check(cau_hosted_record *record, cau_error *error);
// Logs a command that the core has accepted. Also stores the answer to its request if `order` has
// one.
void cau_record_command(cau_hosted_record *record, const cau_command *command,
                        const cau_order *order, const char *text, size_t text_bytes);
// Stores the answer to an order that is not a command.
void cau_record_answer(cau_hosted_record *record, const cau_order *order, const char *text,
                       size_t text_bytes);
void cau_record_state(cau_hosted_record *record, int session_state);
void cau_record_checkpoint(cau_hosted_record *record, uint64_t *hash, size_t *bytes);
// Returns whether a checkpoint is due by the clock or requested. A checkpoint ends the log that a
// restart would have to replay: commands, energy, cuts. While there is nothing to replay, the
// interval doubles each time. So a crash takes an unused session back by at most the time for which
// no client used it.
bool cau_record_is_due(cau_hosted_record *record, bool running, bool energy_on, double now_s);
// Makes the present tick reachable after a restart, by a log entry or by a checkpoint.
void cau_record_reached(cau_hosted_record *record);
// Makes a checkpoint if enough ticks have passed since the last one, or if the log has a gap.
// Returns true if it made one.
bool cau_record_far(cau_hosted_record *record);
// Makes the store keep the state and the events of this tick.
void cau_record_mark(cau_hosted_record *record);
void cau_record_event(cau_hosted_record *record, const cau_wire_timeline_event *event,
                      cau_log_level level);
// Sends the answer once everything recorded so far is on the disk. Takes ownership of `text`.
void cau_record_reply(cau_hosted_record *record, const cau_reply *reply, char *text,
                      size_t text_bytes);
// Notes that the store refused something of this tick, which leaves a gap in the log.
void cau_record_gap(cau_hosted_record *record, const cau_error *error);
// Notes that the log lacks entries from `from_tick` on. The next checkpoint makes the log complete
// again. Any thread may call this.
void cau_commits_lose(cau_hosted_commits *commits, uint64_t from_tick);
// Submits the slice's batch (commit.c).
void cau_record_commit(cau_hosted *h);
// Looks for an earlier answer to the same order, and sends it if there is one (commit.c).
cau_outcome_kind cau_record_resend(cau_hosted *h, cau_order *order);

// ---- replay -------------------------------------------------------------------------------------
// Brings a core to a stored state: restores the nearest checkpoint, then replays the log, in
// slices.

// An entry of the log that is being replayed.
typedef struct cau_replayed {
	uint64_t tick;
	uint32_t order;
	bool acts; // false: the entry has no command (CAU_STORE_REACHED)
	cau_command command;
} cau_replayed;

// A replay that is under way. Only one thread at a time may use this struct.
typedef struct cau_replay {
	void *snapshot; // snapshot of the checkpoint, until the core is restored from it
	size_t snapshot_bytes;
	uint64_t from, until; // ticks between which the log is replayed
	uint64_t tick;        // tick of the core
	bool exact;
	double stepped_s; // processor time of the replayed steps
	cau_replayed *commands;
	size_t count, capacity, at;
} cau_replay;

// Checks whether a tick can be reached. Runs on the builder. First waits until all submitted
// batches are in the store. Returns CAU_BAD_VALUE if the tick cannot be reached. `present`: the
// branch is the session's present branch.
cau_status cau_replay_check(const cau_hosted_identity *identity, const cau_hosted_commits *commits,
                            int64_t branch, bool present, uint64_t tick, cau_error *error);
// Reads the checkpoint and the log of a session's branch up to `tick` (UINT64_MAX: the end).
cau_status cau_replay_read(cau_replay *replay, cau_store *store, const char *session,
                           int64_t branch, uint64_t tick, cau_error *error);
// Restores the core from the checkpoint that cau_replay_read has read. After CAU_CORRUPT the core
// is unchanged. After another failure its state is undefined.
cau_status cau_replay_restore(cau_replay *replay, cau_session *core, cau_error *error);
// Replays the log until its end, or for about `seconds`.
cau_status cau_replay_slice(cau_replay *replay, cau_session *core, double seconds, bool *over,
                            cau_error *error);
// Starts the replay later than at the checkpoint: the core, or the snapshot that replaces the
// checkpoint's, is at `tick`.
void cau_replay_shorten(cau_replay *replay, uint64_t tick);
void cau_replay_finish(cau_replay *replay);
