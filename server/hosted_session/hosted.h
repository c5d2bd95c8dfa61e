// SPDX-License-Identifier: GPL-3.0-or-later
// A session on this daemon: the core's session, its queue, drivers, streams and log. It is a task
// of the worker pool; the functions here may be called from any thread, and none of them waits for
// a step or a disk.
#pragma once

#include "builder/builder.h"
#include "cautery/scene.h"
#include "config/config.h"
#include "hosted_session/beginnings.h"
#include "hosted_session/order.h"
#include "metrics/histogram.h"
#include "session/logic.h"
#include "store/store.h"
#include "stream/stream.h"
#include "worker/pool.h"

// What is measured of all sessions together, those that are gone too.
enum { CAU_HOSTED_STAGES = 8 };
typedef struct cau_hosted_times {
	cau_histogram step;                     // a whole step, wall time
	cau_histogram stage[CAU_HOSTED_STAGES]; // a step's share of each stage
	cau_histogram lateness;                 // of a tick by the clock, when it begins
	cau_histogram command_to_frame; // from a command's arrival to the first frame that shows it
} cau_hosted_times;
const char *cau_hosted_stage_name(int stage); // "global"

// What all sessions share; outlives them.
typedef struct cau_surroundings {
	const cau_config *config;
	cau_store *store;
	bool ephemeral; // the store is in memory: its sessions go with their makers
	cau_worker_pool *pool;
	cau_builder *builder;
	cau_builder *mover;           // for sessions that move; may be the same
	_Atomic int64_t *memory_held; // by all sessions, bytes, about
	cau_beginnings *beginnings;
	cau_sink sink;
	cau_hosted_times *times; // NULL: nobody wants to know
	// Energy came on somewhere: the watchdog must look at its times again.
	void (*armed)(void *user);
	// Makes a new session that starts from the state of another; see cau_hosted_origin.
	void (*fork)(void *user, cau_hosted *source, int64_t branch, const cau_order *order);
	void *user;
} cau_surroundings;

// Where the first state comes from.
typedef struct cau_hosted_origin {
	enum {
		CAU_ORIGIN_SCENE, // tick 0 of its scene
		CAU_ORIGIN_STORE, // its own last state in the store
		CAU_ORIGIN_FORK,  // another session's
	} kind;
	char session[CAU_STORE_ID_BYTES]; // FORK
	int64_t branch;
	uint64_t tick; // FORK
} cau_hosted_origin;

typedef struct cau_hosted_def {
	const char *id;
	uint32_t number;
	cau_scene_def *scene; // malloc'ed, taken; meshes of source bytes point into `meshes`
	void *meshes;         // malloc'ed, taken; may be NULL
	size_t mesh_bytes;
	bool paused;
	bool incoming; // of a move: it is built, `reply` is answered with move_held, and it waits
	cau_hosted_origin origin;
	cau_asker creator;
	int64_t client_sequence;
	cau_reply reply; // answered with session_description once it is stored
} cau_hosted_def;

// One reference, for the caller; the session is in the pool, and the builder builds it.
cau_status cau_hosted_create(cau_hosted **hosted, const cau_surroundings *around,
                             const cau_hosted_def *def, cau_error *error);
cau_hosted *cau_hosted_share(cau_hosted *hosted);
void cau_hosted_release(cau_hosted *hosted); // takes NULL
// Takes the session out of the pool; what waits for it is refused, by the builder if that is at
// work on it. Not from a worker.
void cau_hosted_stop(cau_hosted *hosted);
// Logs that a session of the store could not be brought up, why, and what to do.
void cau_hosted_tell_not_resumed(const char *id, cau_status status, const cau_error *error);

// Writes a result as a whole JSON-RPC answer whose id is the method's name; malloc'ed, NULL on
// failure.
char *cau_answer_text(cau_method method, const void *result, size_t *bytes, cau_error *error);
// The CAU_RPC_* of a batch that the store did not commit; 0: the status's own.
int32_t cau_hosted_commit_code(cau_status status);

const char *cau_hosted_id(const cau_hosted *hosted);
uint32_t cau_hosted_number(const cau_hosted *hosted);
// As it was made. From any thread.
const cau_scene_def *cau_hosted_scene(const cau_hosted *hosted);
// Destroyed, or never came to be: to be forgotten.
bool cau_hosted_ended(cau_hosted *hosted);
// Being built, or its first rows not handed to the store yet.
bool cau_hosted_starting(cau_hosted *hosted);
// Made by this very request.
bool cau_hosted_made_by(const cau_hosted *hosted, const char *client_id, int64_t client_sequence);
void cau_hosted_summary(cau_hosted *hosted, cau_wire_session_summary *summary);

// Queues an order, which is malloc'ed and taken on CAU_OK. CAU_LIMIT: the queue is full; CAU_IO:
// the store takes nothing; CAU_NOT_FOUND: the session is going away. Motion that is refused is
// counted and told to its driver.
cau_status cau_hosted_submit(cau_hosted *hosted, cau_order *order, cau_error *error);

// Answers with a file: its name, and its bytes, which are copied, in chunks.
void cau_hosted_answer_file(const cau_reply *reply, const char *name, const char *media_type,
                            const void *bytes, size_t byte_count);

// ---- sessions that move (hold.c, build_job.c). An order CAU_ORDER_HOLD has one stand still, dark;
// it is answered with move_held when all that it was is on the disk. Then one of these two follows.

// It is served on.
void cau_hosted_go_on(cau_hosted *hosted);
// It ends here: what waits for it and who watches it is told where it is.
void cau_hosted_go_away(cau_hosted *hosted, const cau_moved_to *to);
// Who drives its tools, and its speed, while it stands still. Returns how many.
int32_t cau_hosted_hands(cau_hosted *hosted, cau_drive *drives, double *speed);
// One that was made with `incoming`, and whose reply has been answered with move_held, is served
// from the rows that the store has now, running or paused; `reply` is answered with
// session_description.
void cau_hosted_come(cau_hosted *hosted, int64_t branch, bool paused, const cau_reply *reply);
// Or it ends, and nothing is said of the store's rows.
void cau_hosted_give_up(cau_hosted *hosted);

// ---- drivers

// A client gave a sign of life at `alive_s`, monotonic. It extends the time that its tools may have
// energy, and brings none back that a silence has ended by now.
void cau_hosted_feed(cau_hosted *hosted, uint32_t client, double alive_s);
// The client is gone or looks away: no tick that begins from now on is computed with its energy,
// and everybody is told now; its tools stay where they are. `tell` names the reason in events.
void cau_hosted_cut(cau_hosted *hosted, uint32_t client, const char *tell);
// The client will not come back: its tools have no driver any more.
void cau_hosted_forget_client(cau_hosted *hosted, uint32_t client);
// The store has room again, or has none: energy goes off, and comes on only when it has.
void cau_hosted_store_takes(cau_hosted *hosted, bool takes, const char *reason);
// Cuts the energy of drivers that are silent for too long. Returns the time when it must look
// again, INFINITY if nothing is energized.
double cau_hosted_watch(cau_hosted *hosted, double now_s);
// Its commands that wait for later ticks, in the order in which they came; returns how many. And
// takes such back: the client's (0: anybody's), of this number or (0) all of them; they are
// answered at the next border. Returns how many.
int32_t cau_hosted_waiting(cau_hosted *hosted, cau_wire_waiting_command *list, int32_t capacity);
int32_t cau_hosted_cancel(cau_hosted *hosted, uint32_t client, uint64_t number);

// The client will not come back: a session that is still built for it ends at the next border of
// its stages, and an ephemeral one that it made is destroyed.
void cau_hosted_abandon(cau_hosted *hosted, uint32_t client);
// Whether it is kept in memory alone.
bool cau_hosted_is_ephemeral(const cau_hosted *hosted);
bool cau_hosted_is_own_ephemeral(const cau_hosted *hosted, uint32_t client); // that client's
// Whether the client has it in lock-step.
bool cau_hosted_is_advanced_by(cau_hosted *hosted, uint32_t client);

// ---- streams

// The frame that the subscriber should get now, shared for the caller, or NULL.
cau_buffer *cau_hosted_next_frame(cau_hosted *hosted, cau_subscriber *subscriber, double now_s);
// True if there is something that the subscriber has not got.
bool cau_hosted_has_frame(cau_hosted *hosted, const cau_subscriber *subscriber);
void cau_hosted_leave(cau_hosted *hosted, const cau_subscriber *subscriber);

// ---- for the daemon

// The store was full and is not any more: the log has a gap that only a checkpoint closes.
void cau_hosted_want_checkpoint(cau_hosted *hosted);
// Stops time, cuts energy, writes a checkpoint. cau_hosted_drained tells when that is done.
void cau_hosted_drain(cau_hosted *hosted);
bool cau_hosted_drained(cau_hosted *hosted);

typedef struct cau_hosted_counts {
	uint64_t steps, frames, frame_bytes, key_frames, commands, motions, refused, watchdog_cuts;
	double step_seconds;  // spent in steps
	double energy_gain_j; // that steps made out of nothing, those that lost some not counted
	double realtime_factor;
	int32_t half_rate;                             // subscribers at half rate
	int32_t contacts_left_out, touching_cut_short; // of the last step
	bool resting; // its tissue: steps change nothing until something wakes it
} cau_hosted_counts;
void cau_hosted_count(cau_hosted *hosted, cau_hosted_counts *counts);
