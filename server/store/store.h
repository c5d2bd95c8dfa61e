// SPDX-License-Identifier: GPL-3.0-or-later
// The store: one SQLite file with sessions, branches, command logs, checkpoints, events and the
// answers to requests. Payloads are opaque bytes: the store uses neither the core nor the protocol.
//
//     cau_store_config config = cau_store_default_config();
//     config.path = "/var/lib/cautery/store.db";
//     if (cau_store_open(&config, &store, &error)) ...       // a refused file stays unchanged
//     cau_store_batch *batch = cau_store_batch_create();
//     cau_store_put_command(batch, &command, &error);        // copies
//     if (cau_store_submit(store, batch, on_stored, me, &error)) // any thread, waits for no disk
//         cau_store_batch_destroy(batch);                    // refused: still the caller's
//     ...
//     cau_store_close(store);                                // commits the queued batches
//
// Ticks. A checkpoint at tick T is the state at tick T. A command logged at tick T acts between the
// states at T and T + 1. So the state at T is the newest checkpoint at C <= T, followed by the
// commands with C <= tick < T.
//
// Branches. A session starts on branch 0. Rewinding to tick F opens a branch with fork tick F. The
// new branch shares its parent's commands before F and checkpoints up to F. Its own commands start
// at F. Reads of a branch include the shared past.
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

// The bytes of all tables, compared with config.store_bytes.
typedef enum cau_store_budget_state {
	CAU_STORE_BUDGET_KEPT,
	// the oldest records are removed, until a twentieth of the budget is free
	CAU_STORE_BUDGET_SHRINKING,
	CAU_STORE_BUDGET_BEYOND, // the budget is exceeded, and nothing may be removed
} cau_store_budget_state;

// ---- life -----------------------------------------------------------------------------
typedef struct cau_store_config {
	const char *path; // the database file; "-wal", "-shm" and "-lock" files are beside it
	bool memory;      // true: only in memory, without a path, gone after the close
	// the daemon's label; NULL: the stored one. A label that differs from the stored one is
	// refused. A new store refuses a label with `-`.
	const char *label;
	int32_t commit_delay_ms; // how long a batch may wait for others, 0 to 10
	int32_t queue_batches;   // largest number of batches that are not yet answered
	size_t queue_bytes;      // largest number of bytes of these batches
	int32_t full_retry_ms;   // time between attempts while full, at least 1
	// bytes of one session; beyond them the oldest removable records are removed
	int64_t retention_bytes;
	// bytes of all tables; beyond them the oldest removable records of all are removed; 0: no bound
	int64_t store_bytes;
	int64_t retention_age_ms;      // age at which left branches are removed
	int64_t answer_age_ms;         // age at which recorded answers are removed
	int64_t event_age_ms;          // age at which events are removed
	int32_t retention_interval_ms; // time between retention steps, at least 1
	size_t wal_bytes; // size of the write-ahead log above which it is folded into the file
	int64_t (*wall_clock_ms)(void); // returns Unix time; NULL: the system's clock
	// Called on the store thread when the state changes; may be NULL. After FULL -> READY, the logs
	// of running sessions lack the failed batches: checkpoint every session before its next
	// command.
	void (*on_state)(void *user, cau_store_state state, const char *reason);
	// Called on the store thread after each commit, before the batches' callbacks; may be NULL. A
	// daemon that has lost its label does not return from it.
	void (*on_commit)(void *user);
	// Called on the store thread when the state of the budget changes; may be NULL. `bytes` are in
	// use; `dropped` checkpoints were removed for the budget so far.
	void (*on_budget)(void *user, cau_store_budget_state state, int64_t bytes, int64_t dropped);
	void *user;
} cau_store_config;

// Returns the defaults, in the order of the members from commit_delay_ms to wal_bytes: 5 ms, 4096
// batches, 256 MB, 1 s, 1 GB, no budget, 24 h, 24 h, 30 days, 10 s, 16 MB.
cau_store_config cau_store_default_config(void);

// Opens the store, makes it if there is no file, migrates an older one, and starts its thread. The
// configuration is copied. A refused file stays unchanged, byte for byte:
//   CAU_CORRUPT      not a database, empty, damaged or truncated
//   CAU_UNSUPPORTED  another program's database, or written by a newer schema
//   CAU_BAD_STATE    in use by another process, or of another daemon's label
//   CAU_IO           cannot be read, made or written (a full disk included)
cau_status cau_store_open(const cau_store_config *config, cau_store **store, cau_error *error);

// Commits and answers the queued batches, joins the thread, and closes. `store` may be NULL. Must
// not be called from a callback.
void cau_store_close(cau_store *store);

// Waits until everything submitted before has been answered. Must not be called from a callback.
void cau_store_flush(cau_store *store);

// Returns whether the store thread has looked for work since the last call, and asks it to look
// again. If the result is false again and again, the thread hangs in a commit or a callback. Never
// waits for the disk.
bool cau_store_moves(cau_store *store);

const char *cau_store_label(const cau_store *store); // valid until the store is closed

// Reads the text of the last cau_store_put_generation, by which the daemon names this opening of
// the store. "" if there is none.
cau_status cau_store_read_generation(cau_store *store, char text[CAU_STORE_ID_BYTES],
                                     cau_error *error);

// ---- writing: batches -----------------------------------------------------------------
// A batch is written whole or not at all. Every put copies its arguments, a lend does not. On
// failure (CAU_BAD_VALUE, CAU_LIMIT, CAU_NO_MEMORY) the batch is unchanged.

cau_store_batch *cau_store_batch_create(void);        // returns NULL if memory ran out
void cau_store_batch_destroy(cau_store_batch *batch); // `batch` may be NULL
size_t cau_store_batch_bytes(const cau_store_batch *batch);

typedef struct cau_store_session {
	const char *id;
	const char *name;
	const char *state;          // chosen by the daemon: "running", "paused", ...
	cau_store_bytes definition; // JSON
	cau_store_bytes mesh;       // may be empty
	int64_t branch;             // current branch; 0 in a new session
	int64_t created_ms;         // Unix time; 0 in a put means now
} cau_store_session;

// Adds a new session, on branch 0. The commit fails with CAU_ALREADY_EXISTS if the id is taken.
cau_status cau_store_put_session(cau_store_batch *batch, const cau_store_session *session,
                                 cau_error *error);
cau_status cau_store_put_session_state(cau_store_batch *batch, const char *session,
                                       const char *state, cau_error *error);
// Deletes the session. Its id is free at once; its records are removed in small steps afterwards.
// Recorded answers stay.
cau_status cau_store_delete_session(cau_store_batch *batch, const char *session, cau_error *error);

typedef struct cau_store_command {
	const char *session;
	int64_t branch;
	uint64_t tick;
	uint32_t order; // order within the tick
	int32_t kind;
	cau_store_bytes payload;
	const char *client;     // NULL or "": no client requested it (motion, a watchdog cut)
	uint64_t sequence;      // the client's own count of requests
	cau_store_bytes result; // with a client: the answer that a resend receives
} cau_store_command;

// The kind of a log entry that has no command: it says that the session was advanced to this tick.
// A replay to the end of the log advances to that tick. Such an entry replaces an entry of this
// kind that is the last in the log, and needs far fewer bytes than a checkpoint.
#define CAU_STORE_REACHED (-1)

// Adds a command. With a client, also records the answer in the same batch. The commit fails with
// CAU_ALREADY_EXISTS if the tick and order, or the client's sequence, are taken; with CAU_NOT_FOUND
// if the session or the branch does not exist.
cau_status cau_store_put_command(cau_store_batch *batch, const cau_store_command *command,
                                 cau_error *error);

// The answer to a request that is not a command of a session (create, destroy, rewind, a refusal).
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

// Adds a checkpoint. It replaces a checkpoint at the same tick of the same branch.
cau_status cau_store_put_checkpoint(cau_store_batch *batch, const cau_store_checkpoint *checkpoint,
                                    cau_error *error);
// Adds a checkpoint without a copy: the batch borrows the snapshot until the batch is destroyed.
// After the commit, the store thread destroys the batch and calls give_back. If this function
// fails, the snapshot still belongs to the caller.
cau_status cau_store_lend_checkpoint(cau_store_batch *batch, const cau_store_checkpoint *checkpoint,
                                     void (*give_back)(void *snapshot), cau_error *error);

typedef struct cau_store_event {
	const char *session; // NULL for the daemon's own events
	int64_t branch;      // branch of the session
	uint64_t tick;
	int32_t level;    // in the daemon's scale
	const char *kind; // "watchdog_cut", ...
	const char *text; // plain text or JSON
	int64_t time_ms;  // Unix time; 0 in a put means now
} cau_store_event;
cau_status cau_store_put_event(cau_store_batch *batch, const cau_store_event *event,
                               cau_error *error);
// Removes a branch's events after `tick`, because a session that resumes at that tick has not seen
// them.
cau_status cau_store_forget_events(cau_store_batch *batch, const char *session, int64_t branch,
                                   uint64_t tick, cau_error *error);

typedef struct cau_store_branch {
	const char *session;
	int64_t branch; // > 0 and not used before in this session
	int64_t parent; // -1 if none (branch 0)
	uint64_t fork_tick;
	int64_t opened_ms; // Unix time; ignored in a put
	int64_t left_ms;   // time when another branch became current; 0: never; ignored in a put
	uint64_t end_tick; // retention removed the commands from this tick on; INT64_MAX: none removed;
	                   // ignored in a put
} cau_store_branch;

// Opens a branch and makes it current. If the fork is before the parent's own start, the ancestor
// that owns that tick becomes the parent.
cau_status cau_store_put_branch(cau_store_batch *batch, const cau_store_branch *branch,
                                cau_error *error);

// Stores the text that cau_store_read_generation reads.
cau_status cau_store_put_generation(cau_store_batch *batch, const char *text, cau_error *error);

// Marks the state at this tick. The state and the events of that tick stay as long as the session,
// even on a left branch. The session's first checkpoint stays without a mark.
cau_status cau_store_put_mark(cau_store_batch *batch, const char *session, int64_t branch,
                              uint64_t tick, cau_error *error);

// Commands of the branch with from_tick <= tick < before_tick are missing. A state after from_tick
// and before before_tick cannot be reached unless a checkpoint is there.
typedef struct cau_store_gap {
	const char *session;
	int64_t branch;
	uint64_t from_tick, before_tick;
} cau_store_gap;
// Records a gap. Put it into the batch of the checkpoint that ends the gap, at before_tick.
cau_status cau_store_put_gap(cau_store_batch *batch, const cau_store_gap *gap, cau_error *error);

// ---- writing: sessions that move (rows.h) -------------------------------------------------------
// A session that another daemon has now.
typedef struct cau_store_moved {
	const char *id;   // the session's id here
	const char *move; // id of the move
	// the session's id there, that daemon's label, and its address or ""
	const char *target, *label, *url;
	const char *proof; // allows the other daemon to serve the session
	int64_t time_ms;   // ignored in a put
} cau_store_moved;
// Records that the session has moved away and removes its rows from the tables. Replaces an older
// record of this id. The commit fails with CAU_NOT_FOUND if there is no such session.
cau_status cau_store_put_moved(cau_store_batch *batch, const cau_store_moved *moved,
                               cau_error *error);

typedef enum cau_store_arrival_state {
	CAU_STORE_ARRIVING, // pieces are missing
	CAU_STORE_WHOLE,    // all rows have arrived; another daemon decides who serves the session
	CAU_STORE_ACCEPTED, // the session is this store's
} cau_store_arrival_state;

// A session that arrives from another store.
typedef struct cau_store_arrival {
	const char *id;             // the session's id here
	const char *move;           // id of the move
	const char *lock;           // SHA-256 of the proof, as 64 hex digits
	const char *unlock;         // SHA-256 of the release; "" if the source has an older version
	const char *seal;           // seal of the received pieces; "" if none
	const char *source, *label; // the session's id at the source, and the source's label
	int64_t pieces;             // number of received pieces
	cau_store_arrival_state state;
	int64_t time_ms; // ignored in a put
} cau_store_arrival;
// Adds or replaces the record of an arrival. With ACCEPTED, also removes a record that this id has
// moved away.
cau_status cau_store_put_arrival(cau_store_batch *batch, const cau_store_arrival *arrival,
                                 cau_error *error);
// Removes the record of an arrival and the session's records, if they exist.
cau_status cau_store_forget_arrival(cau_store_batch *batch, const char *id, cau_error *error);
// Adds the rows of a piece to session `id`. cau_rows_check must have accepted the piece. The first
// piece creates the session. The piece is borrowed until the batch is answered, then given back.
cau_status cau_store_lend_rows(cau_store_batch *batch, const char *id, const void *piece,
                               size_t bytes, void (*give_back)(void *piece), cau_error *error);

// ---- writing: submission --------------------------------------------------------------
// Called once for each accepted batch, on the store thread, in the order of submission, without
// locks held. CAU_OK: the batch is on the disk, and no crash or power cut undoes it; `reason` is
// "". On any other status no part of the batch can be relied on, and `reason` says why: CAU_IO (the
// disk refuses), CAU_ALREADY_EXISTS, CAU_NOT_FOUND, CAU_CORRUPT. After CAU_IO the batch may still
// appear after a crash. So the error that the client receives must not promise that nothing
// happened. The callback may submit, but must not flush or close.
typedef void (*cau_store_callback)(void *user, cau_status status, const char *reason);

// Queues the batch. On CAU_OK the batch belongs to the store. `callback` may be NULL. Never waits
// for the disk.
//   CAU_LIMIT      the queue is full: shed or wait for a callback, then submit again
//   CAU_IO         the store is full (disk); see cau_store_health()
//   CAU_CORRUPT    the store is damaged
//   CAU_BAD_STATE  the store is closing
// Before a full store accepts batches again, the callbacks of all failed batches have been called.
cau_status cau_store_submit(cau_store *store, cau_store_batch *batch, cau_store_callback callback,
                            void *user, cau_error *error);

// ---- reading --------------------------------------------------------------------------
// The reads are synchronous and may be called from any thread; they run one at a time and see what
// has been committed. A visitor's values are borrowed until the visitor returns. If a visitor
// returns another status than CAU_OK, the read ends and returns that status. A visitor may not read
// from the same store. All reads can fail with CAU_IO and CAU_CORRUPT.

// Reads every session, oldest first, without its mesh.
typedef cau_status (*cau_store_visit_session)(void *user, const cau_store_session *session);
cau_status cau_store_read_sessions(cau_store *store, cau_store_visit_session visit, void *user,
                                   cau_error *error);
// Reads one session with its mesh. Returns CAU_NOT_FOUND if there is none.
cau_status cau_store_read_session(cau_store *store, const char *id, cau_store_visit_session visit,
                                  void *user, cau_error *error);

typedef cau_status (*cau_store_visit_branch)(void *user, const cau_store_branch *branch);
cau_status cau_store_read_branches(cau_store *store, const char *session,
                                   cau_store_visit_branch visit, void *user, cau_error *error);

// Reads the newest checkpoint at or before `tick` in the branch's line. checkpoint.branch is the
// branch that wrote it. Returns CAU_NOT_FOUND if there is none: the session starts from its
// definition.
typedef cau_status (*cau_store_visit_checkpoint)(void *user,
                                                 const cau_store_checkpoint *checkpoint);
cau_status cau_store_read_checkpoint(cau_store *store, const char *session, int64_t branch,
                                     uint64_t tick, cau_store_visit_checkpoint visit, void *user,
                                     cau_error *error);

// Reads the commands in the branch's line with from_tick <= tick < before_tick, by tick and order.
// Answers are not read. The log is read in pieces, so that a long export does not delay other
// reads. Each piece contains what is committed when it is read.
typedef cau_status (*cau_store_visit_command)(void *user, const cau_store_command *command);
cau_status cau_store_read_log(cau_store *store, const char *session, int64_t branch,
                              uint64_t from_tick, uint64_t before_tick,
                              cau_store_visit_command visit, void *user, cau_error *error);

// Checks that the state at `tick` of the branch can be reached from a checkpoint by a complete log.
// If not, returns CAU_BAD_VALUE (path "params.tick") and names the ticks that can be reached. Call
// it after reading the checkpoint and the log: then it detects anything that was removed during the
// reading.
cau_status cau_store_check_reach(cau_store *store, const char *session, int64_t branch,
                                 uint64_t tick, cau_error *error);
// Reads the first tick from which on every state can be reached, up to the branch's end. Returns
// CAU_NOT_FOUND if the branch has no checkpoint.
cau_status cau_store_read_oldest_tick(cau_store *store, const char *session, int64_t branch,
                                      uint64_t *tick, cau_error *error);

// Reads at most `count` events of one session (NULL: the daemon's own) and of one kind (NULL: any),
// newest first.
typedef cau_status (*cau_store_visit_event)(void *user, const cau_store_event *event);
cau_status cau_store_read_events(cau_store *store, const char *session, const char *kind,
                                 int32_t count, cau_store_visit_event visit, void *user,
                                 cau_error *error);

// Reads at most `count` events of the branch's line with from_tick <= tick <= to_tick, newest
// first. The line includes a parent's events up to and including the fork tick.
cau_status cau_store_read_timeline(cau_store *store, const char *session, int64_t branch,
                                   uint64_t from_tick, uint64_t to_tick, int32_t count,
                                   cau_store_visit_event visit, void *user, cau_error *error);

// Reads the clients that ever had a request recorded in this session, with their highest sequence.
typedef cau_status (*cau_store_visit_client)(void *user, const char *client, uint64_t sequence);
cau_status cau_store_read_clients(cau_store *store, const char *session,
                                  cau_store_visit_client visit, void *user, cau_error *error);

// Reads the recorded answer to a client's request, for a resend. `visit` is called only on CAU_OK.
//   CAU_NOT_FOUND  never recorded: act on it
//   CAU_BAD_STATE  submitted and not yet committed: its callback will bring the answer
//   CAU_ALREADY_EXISTS  its answer, or a newer one of this client, was recorded and is removed
// The store does not know requests that the daemon holds but has not submitted. The daemon must
// remember them.
typedef cau_status (*cau_store_visit_answer)(void *user, const cau_store_answer *answer);
cau_status cau_store_read_answer(cau_store *store, const char *client, uint64_t sequence,
                                 cau_store_visit_answer visit, void *user, cau_error *error);

// Read the sessions that have moved away, and those that have arrived or are arriving.
typedef cau_status (*cau_store_visit_moved)(void *user, const cau_store_moved *moved);
cau_status cau_store_read_moved(cau_store *store, cau_store_visit_moved visit, void *user,
                                cau_error *error);
typedef cau_status (*cau_store_visit_arrival)(void *user, const cau_store_arrival *arrival);
cau_status cau_store_read_arrivals(cau_store *store, cau_store_visit_arrival visit, void *user,
                                   cau_error *error);
// Reads this store's secret, a random text from which the daemon makes proofs for other daemons.
cau_status cau_store_move_secret(cau_store *store, char secret[65], cau_error *error);

// ---- health and metrics ---------------------------------------------------------------
typedef struct cau_store_health {
	cau_store_state state;
	char reason[320]; // why the state is not READY; "" if it is
} cau_store_health;
void cau_store_get_health(cau_store *store, cau_store_health *health);

#define CAU_STORE_SIZE_BUCKETS 13 // number of buckets: for 1, 2, 4, ... 4096 batches in a commit
#define CAU_STORE_TIME_BUCKETS 96 // number of buckets: quarter octaves from 10 microseconds on

typedef struct cau_store_metrics {
	uint64_t commits; // committed groups
	uint64_t batches; // committed batches
	uint64_t records; // committed records
	uint64_t bytes;   // committed bytes
	uint64_t failed_batches;
	uint64_t refused_batches; // batches that submit refused
	uint64_t retired_rows;    // table rows that retention removed
	// bytes of the file in use at retention's last check
	uint64_t kept_bytes;
	uint64_t budget_dropped;                      // checkpoints removed for the budget
	cau_store_budget_state budget;                // present state of the budget
	uint64_t full_count;                          // times the disk was found full
	uint64_t full_attempts;                       // attempts to write again while full
	uint64_t group_size[CAU_STORE_SIZE_BUCKETS];  // groups with at most 2^i batches
	uint64_t commit_time[CAU_STORE_TIME_BUCKETS]; // durations of COMMITs (write, fsync)
	double commit_s;                              // duration of all COMMITs together
	double commit_p50_s, commit_p99_s;            // upper ends of the histogram buckets
	double answer_p50_s, answer_p99_s;            // time from submit to callback
	int32_t queue_batches;                        // batches in the queue now
	size_t queue_bytes;                           // bytes in the queue now
	uint64_t database_bytes;                      // present size of the file
	uint64_t wal_bytes;                           // present size of the write-ahead log
} cau_store_metrics;
void cau_store_get_metrics(cau_store *store, cau_store_metrics *metrics);
double cau_store_time_bucket_s(int bucket); // returns the upper end of a bucket, s

// ---- copies -------------------------------------------------------------------------------------
// Copies a store as of one moment, while its daemon continues to use it.

// Copies the store at `path` to `file`, which must not exist. A daemon may be writing the store.
// The copy has everything that was committed when the copy began, and nothing later. It is checked
// page by page like a store before opening, synced, and only then linked to `file`. Errors:
// CAU_ALREADY_EXISTS: `file` exists; CAU_NOT_FOUND: no store at `path`; CAU_CORRUPT: the copy is
// damaged; CAU_IO.
cau_status cau_store_backup(const char *path, const char *file, cau_error *error);
