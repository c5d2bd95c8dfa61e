// SPDX-License-Identifier: GPL-3.0-or-later
// A session on this daemon: the core's session, its queue, drivers, streams and log. A session is a
// task of the worker pool. Any thread may call these functions. None of them waits for a step or a
// disk.
#pragma once

#include "builder/builder.h"
#include "cautery/scene.h"
#include "cautery/session.h"
#include "config/config.h"
#include "hosted_session/beginnings.h"
#include "hosted_session/order.h"
#include "metrics/exposition.h"
#include "session/logic.h"
#include "store/store.h"
#include "stream/stream.h"
#include "worker/pool.h"

// Times measured over all sessions, including sessions that have ended.
enum { CAU_HOSTED_STAGES = 8 };
typedef struct cau_hosted_times {
	cau_histogram step;                     // wall time of a whole step
	cau_histogram stage[CAU_HOSTED_STAGES]; // wall time of each stage of a step
	cau_histogram lateness;                 // how late a tick began, by the clock
	// time from a command's arrival to the first frame that shows it
	cau_histogram command_to_frame;
} cau_hosted_times;
const char *cau_hosted_stage_name(int stage); // for example "global"

// What all sessions share. It must outlive the sessions.
typedef struct cau_surroundings {
	const cau_config *config;
	cau_store *store;
	bool ephemeral; // the store is in memory: a session is destroyed when its creator is gone
	cau_worker_pool *pool;
	cau_builder *builder;
	cau_builder *mover;           // builder for sessions that move; may be the same as `builder`
	_Atomic int64_t *memory_held; // memory that all sessions take together, bytes, estimated
	cau_beginnings *beginnings;
	cau_sink sink;
	cau_hosted_times *times; // NULL: nothing is measured
	// Called when energy came on in a session: the watchdog must compute its deadlines again.
	void (*armed)(void *user);
	// Creates a session that starts from the state of another (cau_hosted_origin).
	void (*fork)(void *user, cau_hosted *source, int64_t branch, const cau_order *order);
	void *user;
} cau_surroundings;

// Where a session's first state comes from.
typedef struct cau_hosted_origin {
	enum {
		CAU_ORIGIN_SCENE, // tick 0 of its scene
		CAU_ORIGIN_STORE, // its own last state in the store
		CAU_ORIGIN_FORK,  // a state of another session
	} kind;
	char session[CAU_STORE_ID_BYTES]; // FORK: id of the other session
	int64_t branch;
	uint64_t tick; // FORK: tick of the other session
} cau_hosted_origin;

typedef struct cau_hosted_def {
	const char *id;
	uint32_t number;
	// malloc'ed, ownership is taken; meshes with source bytes point into `meshes`
	cau_scene_def *scene;
	void *meshes; // malloc'ed, ownership is taken; may be NULL
	size_t mesh_bytes;
	bool paused;
	// the session arrives by a move: it is built, `reply` is answered with move_held, then it waits
	bool incoming;
	cau_hosted_origin origin;
	cau_asker creator;
	int64_t client_sequence;
	cau_reply reply; // answered with session_description once the session is stored
} cau_hosted_def;

// Creates a session with one reference, for the caller. Adds the session to the pool and lets the
// builder build it.
cau_status cau_hosted_create(cau_hosted **hosted, const cau_surroundings *around,
                             const cau_hosted_def *def, cau_error *error);
cau_hosted *cau_hosted_share(cau_hosted *hosted);
void cau_hosted_release(cau_hosted *hosted); // `hosted` may be NULL
// Removes the session from the pool and refuses its waiting orders. If the builder has the session,
// the builder refuses them. A worker must not call this.
void cau_hosted_stop(cau_hosted *hosted);
// Logs that a session of the store could not be resumed, the reason, and a remedy.
void cau_hosted_tell_not_resumed(const char *id, cau_status status, const cau_error *error);

// Writes a result as a complete JSON-RPC answer whose id is the method's name. Returns malloc'ed
// text, NULL on failure.
char *cau_answer_text(cau_method method, const void *result, size_t *bytes, cau_error *error);
// Returns the CAU_RPC_* code for a batch that the store did not commit; 0: use the status's own
// code.
int32_t cau_hosted_commit_code(cau_status status);

const char *cau_hosted_id(const cau_hosted *hosted);
uint32_t cau_hosted_number(const cau_hosted *hosted);
// Returns the scene from which the session was created. Any thread may read it.
const cau_scene_def *cau_hosted_scene(const cau_hosted *hosted);
// True if the session was destroyed or could not be built. The daemon then forgets it.
bool cau_hosted_ended(cau_hosted *hosted);
// True while the session is being built, or until its first rows are handed to the store.
bool cau_hosted_starting(cau_hosted *hosted);
// True if this very request created the session.
bool cau_hosted_made_by(const cau_hosted *hosted, const char *client_id, int64_t client_sequence);
void cau_hosted_summary(cau_hosted *hosted, cau_wire_session_summary *summary);

// Queues an order, which is malloc'ed. Takes ownership of the order if the result is CAU_OK.
// Errors: CAU_LIMIT: the queue is full; CAU_IO: the store accepts nothing; CAU_NOT_FOUND: the
// session is ending. Refused motion is counted and reported to the client that sent it.
cau_status cau_hosted_submit(cau_hosted *hosted, cau_order *order, cau_error *error);

// Answers with a file: a result with its name, then its bytes in chunks. Copies the bytes.
void cau_hosted_answer_file(const cau_reply *reply, const char *name, const char *media_type,
                            const void *bytes, size_t byte_count);

// ---- sessions that move (hold.c, build_job.c)
// An order CAU_ORDER_HOLD suspends the session, energy off. The daemon answers the order with
// move_held once the session's whole state is on the disk. Then one of the next two functions
// follows.

// Resumes the session on this daemon.
void cau_hosted_go_on(cau_hosted *hosted);
// Ends the session here. Waiting requests and all clients are sent the target daemon.
void cau_hosted_go_away(cau_hosted *hosted, const cau_moved_to *to);
// Copies the drives and the speed of a suspended session. Returns the number of drives.
int32_t cau_hosted_hands(cau_hosted *hosted, cau_drive *drives, double *speed);
// Serves a session that was created with `incoming`, running or paused, from the rows that the
// store has now. Its creation must already be answered with move_held. `reply` is answered with
// session_description.
void cau_hosted_come(cau_hosted *hosted, int64_t branch, bool paused, const cau_reply *reply);
// Ends a session that was created with `incoming` without serving it. The store's rows are not
// touched.
void cau_hosted_give_up(cau_hosted *hosted);

// ---- drivers

// Notes a sign of life of a client at `alive_s` (monotonic). This extends the deadline of energy on
// the client's tools. It never restores energy that was already cut off.
void cau_hosted_feed(cau_hosted *hosted, uint32_t client, double alive_s);
// Cuts off the energy of a client that is disconnected or has its page hidden. No tick that begins
// later is computed with this energy. All subscribers are notified at once, and the tools stay
// where they are. `tell` is the reason that events show.
void cau_hosted_cut(cau_hosted *hosted, uint32_t client, const char *tell);
// Takes the driver from the client's tools, because the client will not return.
void cau_hosted_forget_client(cau_hosted *hosted, uint32_t client);
// Notes whether the store accepts data. If not, energy goes off and stays off until the store
// accepts data again.
void cau_hosted_store_takes(cau_hosted *hosted, bool takes, const char *reason);
// Cuts off the energy of drivers that are silent for too long. Returns the time of the next check,
// INFINITY if no energy is on.
double cau_hosted_watch(cau_hosted *hosted, double now_s);
// cau_hosted_waiting lists the commands that wait for later ticks, in order of arrival, and returns
// their number. cau_hosted_cancel cancels commands of a client (0: of any client) with this number
// (0: with any number), and returns how many. Cancelled commands are answered at the next tick
// border.
int32_t cau_hosted_waiting(cau_hosted *hosted, cau_wire_waiting_command *list, int32_t capacity);
int32_t cau_hosted_cancel(cau_hosted *hosted, uint32_t client, uint64_t number);

// Notes that the client will not return. A session that is still being built for the client ends at
// the next border of its stages. An ephemeral session that the client created is destroyed.
void cau_hosted_abandon(cau_hosted *hosted, uint32_t client);
// True if the session is kept only in memory.
bool cau_hosted_is_ephemeral(const cau_hosted *hosted);
// True if the session is ephemeral and this client created it
bool cau_hosted_is_own_ephemeral(const cau_hosted *hosted, uint32_t client);
// True if the client has the session in lock-step.
bool cau_hosted_is_advanced_by(cau_hosted *hosted, uint32_t client);

// ---- streams

// Returns the frame that the subscriber should receive now, with a reference for the caller, or
// NULL.
cau_buffer *cau_hosted_next_frame(cau_hosted *hosted, cau_subscriber *subscriber, double now_s);
// True if there is a frame that the subscriber has not received.
bool cau_hosted_has_frame(cau_hosted *hosted, const cau_subscriber *subscriber);
void cau_hosted_leave(cau_hosted *hosted, const cau_subscriber *subscriber);

// ---- for the daemon

// Makes a checkpoint soon. The store was full before, so the log has a gap that only a checkpoint
// closes.
void cau_hosted_want_checkpoint(cau_hosted *hosted);
// Stops time, cuts off energy, and writes a checkpoint. cau_hosted_drained returns true once that
// is done.
void cau_hosted_drain(cau_hosted *hosted);
bool cau_hosted_drained(cau_hosted *hosted);

typedef struct cau_hosted_counts {
	uint64_t steps, frames, frame_bytes, key_frames, commands, motions, refused, watchdog_cuts;
	double step_seconds; // wall time of all steps
	// sum of the energy that steps gained; steps that lost energy do not count
	double energy_gain_j;
	double realtime_factor;
	int32_t half_rate; // subscribers that receive frames at half the rate
	int32_t contacts_left_out, touching_cut_short; // counts of the last step
	bool resting; // the tissue is resting: steps change nothing until something wakes it
} cau_hosted_counts;
void cau_hosted_count(cau_hosted *hosted, cau_hosted_counts *counts);

// ---- tools, for transports that drive tools without JSON-RPC messages ---------------------------

typedef struct cau_hosted_tool {
	cau_tool_state state; // of the newest tick
	cau_asker driver;     // client 0: no driver
	bool energized;       // the core's own flag at the end of the last slice
	int energy_off;       // CAU_ENERGY_OFF_*
} cau_hosted_tool;

// Copies the tools into `tools`, at most CAU_MAX_TOOLS, and returns their number; 0 while the
// session starts. *tick and *time_s (simulated, s) are those of the tools. Any thread may call
// this.
int32_t cau_hosted_tools(cau_hosted *hosted, cau_hosted_tool *tools, uint64_t *tick,
                         double *time_s);
// Copies one tool. Returns false if no tool has this name.
bool cau_hosted_find_tool(cau_hosted *hosted, const char *name, cau_hosted_tool *tool);
// Notes a sign of life like cau_hosted_feed, for one tool ("": for all tools of the client).
void cau_hosted_feed_tool(cau_hosted *hosted, uint32_t client, const char *tool, double alive_s);
// Counts motion that a transport refused before it became an order.
void cau_hosted_refuse(cau_hosted *hosted, const char *tool, const cau_asker *asker,
                       uint64_t sequence, const cau_error *error);
// Counts motion that a transport dropped unread, because it named no tool or no known client.
void cau_hosted_count_refused(cau_hosted *hosted, uint64_t count);
