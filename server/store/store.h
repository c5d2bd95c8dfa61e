// SPDX-License-Identifier: GPL-3.0-or-later
// The store: one SQLite file that holds sessions, branches, command logs, checkpoints, events and
// the answers to requests. Payloads are opaque bytes; the store knows no core and no protocol.
//
//     cau_store_config config = cau_store_default_config();
//     config.path = "/var/lib/cautery/store.db";
//     if (cau_store_open(&config, &store, &error)) ...       // what is not ours is left untouched
//     cau_store_batch *batch = cau_store_batch_create();
//     cau_store_put_command(batch, &command, &error);        // copies
//     if (cau_store_submit(store, batch, on_stored, me, &error)) // any thread, waits for no disk
//         cau_store_batch_destroy(batch);                    // refused: still ours
//     ...
//     cau_store_close(store);                                // drains
//
// Ticks. A checkpoint at tick T is the state at tick T. A command logged at tick T acts between the
// states at T and T + 1. So the state at T is: the newest checkpoint at C <= T, then the commands
// with C <= tick < T.
//
// Branches. A session starts on branch 0. Rewinding to tick F opens a branch with fork tick F: it
// shares its parent's commands before F and checkpoints up to F, and its own commands start at F.
// Reads of a branch see the shared past too.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_store cau_store;
typedef struct cau_store_batch cau_store_batch;

#define CAU_STORE_ID_BYTES 128 // longest id, name, state, event kind or client id, NUL included
#define CAU_STORE_BLOB_BYTES 500000000 // largest definition, mesh, payload, result or snapshot

// Borrowed bytes. `data` may be NULL if `bytes` is 0.
typedef struct cau_store_bytes {
	const void *data;
	size_t bytes;
} cau_store_bytes;

// ---- health ---------------------------------------------------------------------------
#define CAU_STORE_STATE_TABLE(X)                                                                   \
	X(READY, "ready")     /* accepts batches */                                                    \
	X(FULL, "full")       /* the disk refuses writes; tried again every full_retry_ms */           \
	X(DAMAGED, "damaged") /* the file was found corrupt while running; final */                    \
	X(CLOSING, "closing")
typedef enum cau_store_state {
#define X(code, name) CAU_STORE_##code,
	CAU_STORE_STATE_TABLE(X)
#undef X
		CAU_STORE_STATE_COUNT
} cau_store_state;

const char *cau_store_state_name(cau_store_state state);

// What all tables take, against config.store_bytes.
typedef enum cau_store_budget_state {
	CAU_STORE_BUDGET_KEPT,
	CAU_STORE_BUDGET_SHRINKING, // the oldest go, until a twentieth of the budget is free
	CAU_STORE_BUDGET_BEYOND,    // and nothing is left that may go
} cau_store_budget_state;

// ---- life -----------------------------------------------------------------------------
typedef struct cau_store_config {
	const char *path;         // the database; "-wal", "-shm" and "-lock" files stand beside it
	bool memory;              // in memory alone, without a path: it is gone once it is closed
	const char *label;        // the daemon's label; NULL takes the stored one; another is refused,
	                          // and one with a `-` in a new store
	int32_t commit_delay_ms;  // 0 to 10: how long a batch may wait for company
	int32_t queue_batches;    // bound on batches not yet answered
	size_t queue_bytes;       // bound on their bytes
	int32_t full_retry_ms;    // between attempts while full, at least 1
	int64_t retention_bytes;  // per session; beyond it the oldest of what may go goes first
	int64_t store_bytes;      // of all tables; beyond it the oldest of any goes first; 0: no bound
	int64_t retention_age_ms; // left branches
	int64_t answer_age_ms;    // recorded answers
	int64_t event_age_ms;     // events
	int32_t retention_interval_ms; // between looks for something to remove, at least 1
	size_t wal_bytes; // the write-ahead log is folded into the file when it grows past this
	int64_t (*wall_clock_ms)(void); // Unix time; NULL: the system's
	// Called on the store's thread when the state changes; may be NULL. On FULL -> READY the logs
	// of running sessions lack what failed: checkpoint every session before its next command.
	void (*on_state)(void *user, cau_store_state state, const char *reason);
	// Called on the store's thread after each commit, before anybody hears of it; may be NULL. A
	// daemon that has lost its label does not return from it.
	void (*on_commit)(void *user);
	// Likewise, of the budget; `bytes` are taken, `dropped` checkpoints went for it so far.
	void (*on_budget)(void *user, cau_store_budget_state state, int64_t bytes, int64_t dropped);
	void *user;
} cau_store_config;

// 5 ms, 4096 batches, 256 MB, 1 s, 1 GB, no budget, 24 h, 24 h, 30 days, 10 s, 16 MB.
cau_store_config cau_store_default_config(void);

// Opens the store, makes it if nothing is there, migrates it if it is older, and starts its thread.
// The configuration is copied. A file that is refused is left as it was, byte for byte:
//   CAU_CORRUPT      not a database, empty, damaged or truncated
//   CAU_UNSUPPORTED  another program's database, or written by a newer schema
//   CAU_BAD_STATE    in use by another process, or of another daemon's label
//   CAU_IO           cannot be read, made or written (a full disk among it)
cau_status cau_store_open(const cau_store_config *config, cau_store **store, cau_error *error);

// Commits what is queued, answers it, joins the thread, closes. Takes NULL. Not from a callback.
void cau_store_close(cau_store *store);

// Waits until everything submitted before has been answered. Not from a callback.
void cau_store_flush(cau_store *store);

// Whether the store's thread has come round since this was asked last, and asks it to: false again
// and again is a thread that hangs in a commit or a callback. Waits for no disk.
bool cau_store_moves(cau_store *store);

const char *cau_store_label(const cau_store *store); // lives as long as the store

// Which opening of the store this is, in the daemon's words; "" in one that was never told.
cau_status cau_store_read_generation(cau_store *store, char text[CAU_STORE_ID_BYTES],
                                     cau_error *error);

// ---- writing: batches -----------------------------------------------------------------
// A batch is written whole or not at all. Every put copies what it is given, a lend does not; on
// failure (CAU_BAD_VALUE, CAU_LIMIT, CAU_NO_MEMORY) the batch is as it was before.

cau_store_batch *cau_store_batch_create(void);        // NULL if memory ran out
void cau_store_batch_destroy(cau_store_batch *batch); // takes NULL
size_t cau_store_batch_bytes(const cau_store_batch *batch);

typedef struct cau_store_session {
	const char *id;
	const char *name;
	const char *state;          // the daemon's word: "running", "paused", ...
	cau_store_bytes definition; // JSON
	cau_store_bytes mesh;       // may be empty
	int64_t branch;             // current; 0 in a new session
	int64_t created_ms;         // Unix time; 0 in a put: now
} cau_store_session;

// A new session, on branch 0. Its commit fails with CAU_ALREADY_EXISTS if the id is taken.
cau_status cau_store_put_session(cau_store_batch *batch, const cau_store_session *session,
                                 cau_error *error);
cau_status cau_store_put_session_state(cau_store_batch *batch, const char *session,
                                       const char *state, cau_error *error);
// The id is free at once; rows go in small steps afterwards. Recorded answers stay.
cau_status cau_store_delete_session(cau_store_batch *batch, const char *session, cau_error *error);

typedef struct cau_store_command {
	const char *session;
	int64_t branch;
	uint64_t tick;
	uint32_t order; // within the tick
	int32_t kind;
	cau_store_bytes payload;
	const char *client;     // NULL or "": nobody's request (motion, a watchdog cut)
	uint64_t sequence;      // the client's own count
	cau_store_bytes result; // with a client: the answer that a resend gets
} cau_store_command;

// The kind of a row of the log without a command: the session was brought to this tick. Who goes to
// the end of the log goes as far as that. It takes the place of such a row that is the log's last,
// and far less room than a checkpoint.
#define CAU_STORE_REACHED (-1)

// With a client, records the answer in the same batch. Its commit fails with CAU_ALREADY_EXISTS if
// the tick and order, or the client's sequence, are taken, and with CAU_NOT_FOUND if session or
// branch are not there.
cau_status cau_store_put_command(cau_store_batch *batch, const cau_store_command *command,
                                 cau_error *error);

// The answer to a request that is no command of a session (create, destroy, rewind, a refusal).
// `session` may be NULL.
typedef struct cau_store_answer {
	const char *client;
	uint64_t sequence;
	const char *session;
	cau_store_bytes result;
} cau_store_answer;
cau_status cau_store_put_answer(cau_store_batch *batch, const cau_store_answer *answer,
                                cau_error *error);

typedef struct cau_store_checkpoint {
	const char *session;
	int64_t branch;
	uint64_t tick;
	uint64_t hash;
	cau_store_bytes snapshot;
} cau_store_checkpoint;

// Replaces one at the same tick of the same branch.
cau_status cau_store_put_checkpoint(cau_store_batch *batch, const cau_store_checkpoint *checkpoint,
                                    cau_error *error);
// The same, but the snapshot is the batch's until that is destroyed, by whoever has it then: after
// the commit that is the store's thread, which gives it back there. After a failure it is the
// caller's still.
cau_status cau_store_lend_checkpoint(cau_store_batch *batch, const cau_store_checkpoint *checkpoint,
                                     void (*give_back)(void *snapshot), cau_error *error);

typedef struct cau_store_event {
	const char *session; // NULL: the daemon's own
	int64_t branch;      // of the session
	uint64_t tick;
	int32_t level;    // the daemon's scale
	const char *kind; // "watchdog_cut", ...
	const char *text; // text or JSON
	int64_t time_ms;  // Unix time; 0 in a put: now
} cau_store_event;
cau_status cau_store_put_event(cau_store_batch *batch, const cau_store_event *event,
                               cau_error *error);
// Takes back a branch's events after `tick`: a session that was resumed there has not seen them.
cau_status cau_store_forget_events(cau_store_batch *batch, const char *session, int64_t branch,
                                   uint64_t tick, cau_error *error);

typedef struct cau_store_branch {
	const char *session;
	int64_t branch; // unused so far in this session, > 0
	int64_t parent; // -1: none (branch 0)
	uint64_t fork_tick;
	int64_t opened_ms; // Unix time; ignored in a put
	int64_t left_ms;   // when another became current; 0: never; ignored in a put
	uint64_t
		end_tick; // retention removed the commands from here on; INT64_MAX: none; ignored in a put
} cau_store_branch;

// Opens a branch and makes it current. If the fork lies before the parent's own start, the ancestor
// that owns that tick becomes the parent.
cau_status cau_store_put_branch(cau_store_batch *batch, const cau_store_branch *branch,
                                cau_error *error);

// What cau_store_read_generation reads from then on.
cau_status cau_store_put_generation(cau_store_batch *batch, const char *text, cau_error *error);

// The state at this tick stays as long as the session, on a branch that has been left too, and so
// do the events of that tick. The session's first checkpoint stays without a mark.
cau_status cau_store_put_mark(cau_store_batch *batch, const char *session, int64_t branch,
                              uint64_t tick, cau_error *error);

// The branch's log lacks commands with from_tick <= tick < before_tick: no state after the first of
// these ticks and before the last can be reached but by a checkpoint there.
typedef struct cau_store_gap {
	const char *session;
	int64_t branch;
	uint64_t from_tick, before_tick;
} cau_store_gap;
// To be told with the checkpoint that ends it, at before_tick.
cau_status cau_store_put_gap(cau_store_batch *batch, const cau_store_gap *gap, cau_error *error);

// ---- writing: sessions that move (dump.h reads them, rows.h is how they travel) -----------------
// What another daemon has now.
typedef struct cau_store_moved {
	const char *id;                   // here
	const char *move;                 // which move it was
	const char *target, *label, *url; // its id there, that daemon's label, and its address or ""
	const char *proof;                // what lets the other daemon serve it
	int64_t time_ms;                  // ignored in a put
} cau_store_moved;
// The session's rows go, its id leads elsewhere from here on. In place of an older such row.
// CAU_NOT_FOUND: there is no such session.
cau_status cau_store_put_moved(cau_store_batch *batch, const cau_store_moved *moved,
                               cau_error *error);

typedef enum cau_store_arrival_state {
	CAU_STORE_ARRIVING, // pieces are missing
	CAU_STORE_WHOLE,    // all rows are here; who serves it is decided elsewhere
	CAU_STORE_ACCEPTED, // it is this store's
} cau_store_arrival_state;

// A session that comes from another store.
typedef struct cau_store_arrival {
	const char *id;             // here
	const char *move;           // which move it is
	const char *lock;           // SHA-256 of the proof, 64 hex digits
	const char *unlock;         // SHA-256 of the release; "": of an older version
	const char *seal;           // of the pieces that are here; "": none
	const char *source, *label; // its id there, and that daemon's label
	int64_t pieces;             // that are here
	cau_store_arrival_state state;
	int64_t time_ms; // ignored in a put
} cau_store_arrival;
// Makes or replaces the row. ACCEPTED: a row that says that this id has moved away goes with it.
cau_status cau_store_put_arrival(cau_store_batch *batch, const cau_store_arrival *arrival,
                                 cau_error *error);
// The row and the session's go, if they are there.
cau_status cau_store_forget_arrival(cau_store_batch *batch, const char *id, cau_error *error);
// The rows of a piece that cau_rows_check has passed, into session `id`, which its first makes.
// Borrowed until the batch is answered, then given back.
cau_status cau_store_lend_rows(cau_store_batch *batch, const char *id, const void *piece,
                               size_t bytes, void (*give_back)(void *piece), cau_error *error);

// ---- writing: submission --------------------------------------------------------------
// Called once per accepted batch, on the store's thread, without locks held, in the order of
// submission. CAU_OK: the batch is on the disk, and no crash or power cut undoes it. Else nothing
// of it is to be relied on: CAU_IO (the disk refuses), CAU_ALREADY_EXISTS, CAU_NOT_FOUND,
// CAU_CORRUPT; `reason` says why and is "" otherwise. After CAU_IO a crash may still bring the
// batch to light, so answer the client with an error that does not promise that nothing happened.
// May submit; must not flush or close.
typedef void (*cau_store_callback)(void *user, cau_status status, const char *reason);

// Queues the batch; on CAU_OK it belongs to the store. `callback` may be NULL. Never waits for the
// disk.
//   CAU_LIMIT      the queue is full: shed or wait for a callback, then submit again
//   CAU_IO         the store is full (disk); see cau_store_health()
//   CAU_CORRUPT    the store is damaged
//   CAU_BAD_STATE  the store is closing
// All failures of earlier batches are called back before a full store accepts again.
cau_status cau_store_submit(cau_store *store, cau_store_batch *batch, cau_store_callback callback,
                            void *user, cau_error *error);

// ---- reading --------------------------------------------------------------------------
// Synchronous, from any thread, one at a time; sees what has been committed. Visitors get borrowed
// values that live until they return; a status other than CAU_OK ends the reading and is returned.
// A visitor may not read from the same store. CAU_IO and CAU_CORRUPT as usual.

// Every session, oldest first, without its mesh.
typedef cau_status (*cau_store_visit_session)(void *user, const cau_store_session *session);
cau_status cau_store_read_sessions(cau_store *store, cau_store_visit_session visit, void *user,
                                   cau_error *error);
// One session with its mesh. CAU_NOT_FOUND.
cau_status cau_store_read_session(cau_store *store, const char *id, cau_store_visit_session visit,
                                  void *user, cau_error *error);

typedef cau_status (*cau_store_visit_branch)(void *user, const cau_store_branch *branch);
cau_status cau_store_read_branches(cau_store *store, const char *session,
                                   cau_store_visit_branch visit, void *user, cau_error *error);

// The newest checkpoint at or before `tick` that the branch sees. CAU_NOT_FOUND if there is none:
// the session starts from its definition. checkpoint.branch is the branch that wrote it.
typedef cau_status (*cau_store_visit_checkpoint)(void *user,
                                                 const cau_store_checkpoint *checkpoint);
cau_status cau_store_read_checkpoint(cau_store *store, const char *session, int64_t branch,
                                     uint64_t tick, cau_store_visit_checkpoint visit, void *user,
                                     cau_error *error);

// The commands that the branch sees with from_tick <= tick < before_tick, by tick and order.
// Results are not read. Reads in pieces, so a long export does not hold others up; it sees what is
// committed by then.
typedef cau_status (*cau_store_visit_command)(void *user, const cau_store_command *command);
cau_status cau_store_read_log(cau_store *store, const char *session, int64_t branch,
                              uint64_t from_tick, uint64_t before_tick,
                              cau_store_visit_command visit, void *user, cau_error *error);

// Whether the state at `tick`, as the branch sees it, can be reached from a checkpoint by a log
// that is whole. CAU_BAD_VALUE (path "params.tick") names what can be reached. To be asked after
// the checkpoint and the log were read: then nothing that was missing passes unnoticed.
cau_status cau_store_check_reach(cau_store *store, const char *session, int64_t branch,
                                 uint64_t tick, cau_error *error);
// The first tick from which on every state can be reached, up to the branch's end. CAU_NOT_FOUND if
// it has no checkpoint.
cau_status cau_store_read_oldest_tick(cau_store *store, const char *session, int64_t branch,
                                      uint64_t *tick, cau_error *error);

// Events of one session (NULL: the daemon's own), of one kind (NULL: any), newest first, at most
// `count`.
typedef cau_status (*cau_store_visit_event)(void *user, const cau_store_event *event);
cau_status cau_store_read_events(cau_store *store, const char *session, const char *kind,
                                 int32_t count, cau_store_visit_event visit, void *user,
                                 cau_error *error);

// The events that the branch sees with from_tick <= tick <= to_tick, newest first, at most `count`.
// Of an older branch it sees those up to its fork tick, that tick's among them.
cau_status cau_store_read_timeline(cau_store *store, const char *session, int64_t branch,
                                   uint64_t from_tick, uint64_t to_tick, int32_t count,
                                   cau_store_visit_event visit, void *user, cau_error *error);

// Clients that ever had a request recorded in this session, with the highest sequence.
typedef cau_status (*cau_store_visit_client)(void *user, const char *client, uint64_t sequence);
cau_status cau_store_read_clients(cau_store *store, const char *session,
                                  cau_store_visit_client visit, void *user, cau_error *error);

// The recorded answer to a client's request, for a resend. `visit` is called on CAU_OK only.
//   CAU_NOT_FOUND  never recorded: act on it
//   CAU_BAD_STATE  submitted and not yet committed: its callback will bring the answer
//   CAU_ALREADY_EXISTS  recorded once, or older than one that was, and not kept any more
// A request that the daemon holds but has not submitted yet is the daemon's to remember.
typedef cau_status (*cau_store_visit_answer)(void *user, const cau_store_answer *answer);
cau_status cau_store_read_answer(cau_store *store, const char *client, uint64_t sequence,
                                 cau_store_visit_answer visit, void *user, cau_error *error);

// Sessions that have moved away, and those that have come or are coming.
typedef cau_status (*cau_store_visit_moved)(void *user, const cau_store_moved *moved);
cau_status cau_store_read_moved(cau_store *store, cau_store_visit_moved visit, void *user,
                                cau_error *error);
typedef cau_status (*cau_store_visit_arrival)(void *user, const cau_store_arrival *arrival);
cau_status cau_store_read_arrivals(cau_store *store, cau_store_visit_arrival visit, void *user,
                                   cau_error *error);
// A random text that is this store's alone, from which it makes proofs for other daemons.
cau_status cau_store_move_secret(cau_store *store, char secret[65], cau_error *error);

// ---- health and metrics ---------------------------------------------------------------
typedef struct cau_store_health {
	cau_store_state state;
	char reason[320]; // why it is not ready, "" if it is
} cau_store_health;
void cau_store_get_health(cau_store *store, cau_store_health *health);

#define CAU_STORE_SIZE_BUCKETS 13 // batches per commit: 1, 2, 4, ... 4096
#define CAU_STORE_TIME_BUCKETS 96 // quarter octaves from 10 microseconds

typedef struct cau_store_metrics {
	uint64_t commits; // groups committed
	uint64_t batches; // committed
	uint64_t records; // committed
	uint64_t bytes;   // committed
	uint64_t failed_batches;
	uint64_t refused_batches;                     // by submit
	uint64_t retired_rows;                        // removed by retention
	uint64_t kept_bytes;                          // of the file in use, at retention's last look
	uint64_t budget_dropped;                      // checkpoints that went for the budget
	cau_store_budget_state budget;                // now
	uint64_t full_count;                          // times the disk was found full
	uint64_t full_attempts;                       // made while full, to write again
	uint64_t group_size[CAU_STORE_SIZE_BUCKETS];  // groups with at most 2^i batches
	uint64_t commit_time[CAU_STORE_TIME_BUCKETS]; // COMMITs (write, fsync) by duration
	double commit_s;                              // all COMMITs together
	double commit_p50_s, commit_p99_s;            // upper ends of their buckets
	double answer_p50_s, answer_p99_s;            // from submit to callback
	int32_t queue_batches;                        // now
	size_t queue_bytes;                           // now
	uint64_t database_bytes;                      // the file, now
	uint64_t wal_bytes;                           // the write-ahead log, now
} cau_store_metrics;
void cau_store_get_metrics(cau_store *store, cau_store_metrics *metrics);
double cau_store_time_bucket_s(int bucket); // upper end, seconds
