// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share. `worker` marks what only whoever has the session touches: the
// worker that runs its slice, or, while it is `away`, the builder. The rest is guarded by the
// mutex, which is held for moments only.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "buffer/shelf.h"
#include "cautery/session.h"
#include "clock/clock.h"
#include "hosted_session/hosted.h"
#include "log/log.h"
#include "session/logic.h"
#include "trace/trace.h"

enum {
	EVENT_COUNT = 512, // of the timeline kept in memory
	SNAPSHOT_COUNT = 64,
	CUT_MERGE_TICKS = 30, // cuts of neighbouring ticks are one event, and so are tears
	WAITING_COUNT = 32,   // commands between two frames whose wait is measured
};

// Refused motion of a tool, told once a second.
typedef struct cau_refused_motion {
	char tool[CAU_NAME_BYTES]; // "": the place is free
	int64_t count;
	double told_s;
	uint32_t client;
	uint64_t sequence; // of the newest
	cau_error error;
} cau_refused_motion;

// An entry of the log that is being replayed.
typedef struct cau_replayed {
	uint64_t tick;
	uint32_t order;
	bool acts; // it has a command: see CAU_STORE_REACHED
	cau_command command;
} cau_replayed;

// Going to a state of the store; in slices.
typedef struct cau_replay {
	void *snapshot; // of the checkpoint, until the core has it
	size_t snapshot_bytes;
	uint64_t from, until; // ticks
	uint64_t tick;        // where the core is
	bool exact;
	double stepped_s; // processor time of its steps
	cau_replayed *commands;
	size_t count, capacity, at;
} cau_replay;

typedef struct cau_named_snapshot {
	char name[CAU_NAME_BYTES];
	int64_t branch;
	uint64_t tick;
} cau_named_snapshot;

// Answers that wait for their commit.
typedef struct cau_pending {
	struct cau_pending *next;
	cau_reply reply;
	char *text; // malloc'ed
	size_t text_bytes;
} cau_pending;

typedef struct cau_looks cau_looks;

struct cau_hosted {
	cau_task task; // first
	atomic_int references;
	const cau_surroundings *around;
	char id[CAU_NAME_BYTES];
	uint32_t number;

	// worker
	cau_scene_def *scene;   // as it was made
	cau_scene_def *present; // room for a description
	void *meshes;
	size_t mesh_bytes;
	cau_hosted_origin origin;
	cau_asker creator;
	int64_t creator_sequence;
	cau_reply creator_reply;   // read by cau_hosted_take_creator
	atomic_bool creator_waits; // creator_reply is to be answered
	cau_session *core;
	cau_session_info info;
	bool pause_at_start;
	uint64_t tick, first_tick;
	int64_t branch, next_branch;
	uint64_t logged_tick;  // of the last log entry
	uint32_t logged_order; // entries of that tick
	bool logged_acts;      // some of these are commands
	uint64_t epoch;
	cau_replay replay;
	bool replaying; // after a restart or a fork, on the workers
	bool incoming;  // of a move, and not accepted yet: it is built and then waits for that
	bool came;      // and has been since
	struct cau_holding *holding; // it stands still, to leave; NULL: it does not
	cau_job *built;              // that built it, while it waits to be accepted; else NULL
	cau_job *leaving; // what the builder is to do with it once this slice has ended; NULL: nothing
	cau_store_batch *batch; // of this slice; NULL: nothing to write
	uint64_t batch_tick;    // when it was begun
	uint64_t batch_lost;    // a log that is lost from here on ends with this batch's checkpoint
	bool batch_acts;        // it has log entries since its last checkpoint
	cau_pending *pending;   // answers that wait for it
	double checkpoint_s;
	bool touched;              // since then by commands or cuts
	int32_t quiet_checkpoints; // in a row, each before which nothing happened
	uint64_t checkpoint_tick;
	double window_s; // realtime_factor's window
	uint64_t window_tick;
	double step_cost_s, realtime_factor;
	char odd_tool[CAU_NAME_BYTES]; // that the core would heat and the machine does not
	bool rule_reported;            // that a safety rule of the decisions was broken
	double late_s; // how late the tick that is to be made began; below 0: the clock does not say
	double waiting_s[WAITING_COUNT]; // when commands came that no frame has shown yet
	int32_t waiting_count;
	char stage[32];        // what the builder does with it; else ""
	int64_t memory_held;   // of what all sessions may take
	cau_order *destroyers; // of those in `cancelling` the ones that are no resends, in their order
	bool unwanted;         // it was cancelled
	bool adopted;          // its threads are the workers'
	double piece_s;        // processor time of the longest step lately, for the pool
	double stepped_s;      // of the steps in this slice
	cau_shelf *snapshot_shelf, *copy_shelf; // memory for checkpoints, and for what files show
	int32_t elements_removed, elements_torn;
	uint32_t vessel_flags[CAU_MAX_VESSELS]; // as reported
	uint32_t inverted_layers;               // whose tetrahedra were reported, a bit each
	uint64_t gain_tick;                     // of the last report that steps gained energy; 0: none
	uint32_t refused_commands;
	cau_named_snapshot snapshots[SNAPSHOT_COUNT];
	int32_t snapshot_count;
	cau_wire_timeline_event events[EVENT_COUNT]; // ring, of the present line
	uint64_t event_count;
	bool events_older; // the store has some from before
	uint64_t cut_open,
		tear_open; // the event, and 1, that may grow; nobody knows of it yet; 0: none

	// What is decided. Its lock is held for moments, never across the core, and inside no other
	// lock of the session; what clients are told of a decision is told under it, in its order.
	pthread_mutex_t deciding;
	cau_logic *logic; // orders are its tickets
	FILE *trace;      // of its calls; NULL: none is wanted

	cau_streams streams; // with a lock of its own

	pthread_mutex_t mutex;
	cau_order *cancelling; // session.destroy while it is built
	cau_looks *looks;      // frame_at.c; NULL: nobody looked at the past yet
	cau_order *reads;      // read_queue.c
	int32_t read_count;
	cau_refused_motion refused[CAU_MAX_TOOLS];
	cau_tool_state tools[CAU_MAX_TOOLS]; // of the newest tick, for transports
	int32_t tool_count;
	uint64_t tools_tick;
	double tools_time_s;
	cau_wire_session_summary summary;
	cau_hosted_counts counts;
	// The store lacks commands from this tick on, until a checkpoint is stored; UINT64_MAX: none.
	_Atomic uint64_t lost_from;
	atomic_bool unanswered; // its making is not with the store yet
	atomic_int unmade;      // a cau_status: why the store has not taken its first rows
	atomic_bool ended, starting, checkpoint_wanted, drain_wanted, drained;
	atomic_bool dirty;     // streams must show a change that no step made
	atomic_bool away;      // it is the builder's, who alone ends this: no worker touches it
	atomic_bool abandoned; // its creator is gone
	cau_moved_to moved;    // once it has ended: where it went; written before `ended`
	atomic_int files;      // of this session that the builder makes
	atomic_int commits;    // on their way to the disk
};

// ---- hosted.c
// There is no session for it any more.
void cau_hosted_refuse_gone(cau_hosted *h, cau_order *order);
// It could not be brought up or kept: nothing is taken any more. From any thread.
void cau_hosted_end(cau_hosted *h);
// Hands out the reply to the session's creator, once: the caller answers it. False after the first
// call. Any thread.
bool cau_hosted_take_creator(cau_hosted *h, cau_reply *reply);
// Answers the session's creator with an error. Does nothing if the reply was taken before. Any
// thread.
void cau_hosted_fail_creator(cau_hosted *h, const cau_error *error, int32_t code);

// ---- run.c
cau_due cau_hosted_run(cau_task *task);

// ---- slice.c
void cau_hosted_end_slice(cau_hosted *h); // commits, and tells others what they may know
// Refuses an order, which it takes.
void cau_hosted_refuse_order(cau_hosted *h, cau_order *order, const cau_error *error, int32_t code);
// It has ended: what waits is refused. By whoever has it: its worker, the builder, or after both.
void cau_hosted_refuse_rest(cau_hosted *h);

// ---- summary.c
void cau_hosted_publish_summary(cau_hosted *h);

// ---- tools.c
void cau_hosted_publish_tools(cau_hosted *h); // for other threads to read

// ---- export.c
size_t cau_export_copy_bytes(const cau_session_info *info); // of what a file shows of a tick

// ---- building.c: the borders of its stages
// Between two stages.
cau_status cau_building_border(void *user, const cau_build_border *border, cau_error *error);
// Counts `more` bytes as the session's. CAU_LIMIT, where the settings do not allow them.
cau_status cau_building_hold(cau_hosted *h, size_t more, cau_error *error);
// CAU_BAD_STATE, where the session is destroyed or the daemon ends. `doing`: "was being built".
cau_status cau_building_check(cau_hosted *h, const char *doing, const char *next, cau_error *error);
// Takes the order if it destroys a session that is away.
bool cau_building_cancel(cau_hosted *h, cau_order *order);
// Whether somebody destroys it: h->destroyers.
bool cau_building_destroyed(cau_hosted *h);
// From here on it is the workers', and a session.destroy waits in the queue. Returns those that
// came before.
cau_order *cau_building_give_back(cau_hosted *h);

// ---- build_job.c
// About how long it takes to build, s.
double cau_building_expects_s(const cau_scene_def *scene);
// Leaves a session that was just made to the builder.
cau_status cau_building_begin(cau_hosted *h, cau_error *error);
// The builder's last slice of a session that was away: it is the workers' again, or has ended.
void cau_building_over(cau_hosted *h);

// ---- start.c: builds the core, loads the state; on the builder
void cau_hosted_start(cau_hosted *h);
void cau_hosted_fail_start(cau_hosted *h, const cau_error *error);
void cau_hosted_started(cau_hosted *h); // after the replay of a start

// Brings a session up whose core is built, from the rows that the store has now.
void cau_hosted_resume(cau_hosted *h);

// ---- replay.c: the way of a core to a state of the store
// On the builder. Before the past is read, all of it that is on its way must be in the store.
// CAU_BAD_VALUE: that tick cannot be reached; `present`: the branch is the present one.
cau_status cau_replay_check(cau_hosted *h, int64_t branch, bool present, uint64_t tick,
                            cau_error *error);
// Reads the checkpoint and the log of a session's branch up to `tick` (UINT64_MAX: the end).
cau_status cau_replay_read(cau_replay *replay, cau_store *store, const char *session,
                           int64_t branch, uint64_t tick, cau_error *error);
// Has the core be at that checkpoint. After CAU_CORRUPT it is as it was, after another failure it
// may be anywhere.
cau_status cau_replay_restore(cau_replay *replay, cau_session *core, cau_error *error);
// Steps on along the log, until that is over or some seconds are.
cau_status cau_replay_slice(cau_replay *replay, cau_session *core, double seconds, bool *over,
                            cau_error *error);
// The core is, or the snapshot will take it, further than the checkpoint: at `tick`, on this way.
void cau_replay_shorten(cau_replay *replay, uint64_t tick);
void cau_replay_finish(cau_replay *replay);

// ---- decide.c: the session's decisions, from any thread
// Takes one event, and does what it leads to but for what is the worker's.
void cau_decide(cau_hosted *h, const cau_logic_event *event);
// The same for an order, which is taken on CAU_OK.
cau_status cau_decide_order(cau_hosted *h, cau_order *order, const cau_asked *asked,
                            cau_error *error);
// What the worker is to do now, and what came of it.
// Whether a safety rule was broken, the first time that this is asked. `reason`: 320 bytes.
bool cau_decide_broken(cau_hosted *h, char *reason, size_t bytes);
// Of CAU_ACT_STEP: h->odd_tool is "" if the core heats what the machine has on, and nothing else.
void cau_decide_next(cau_hosted *h, cau_action *action);
void cau_decide_done(cau_hosted *h, cau_outcome_kind outcome);
void cau_decide_stepped(cau_hosted *h, const char *fault);
// Answers an off or a pause, and frees it. It acts at the next tick border, whatever the store
// says; the log will not show it.
void cau_hosted_answer_unstored(cau_hosted *h, cau_order *order);
// Opens the trace, where one is wanted; before anything is decided.
void cau_decide_trace(cau_hosted *h);
void cau_decide_flush_trace(cau_hosted *h); // worker
// The core is at a state with these tools: after a start, rewind, reset or restore.
void cau_decide_arrived(cau_hosted *h, int state, const char *cause);
// A copy of a tool's drive. False: there is none.
bool cau_decide_find(cau_hosted *h, const char *tool, cau_drive *drive);
// Copies of all, at most CAU_MAX_TOOLS.
int32_t cau_decide_drives(cau_hosted *h, cau_drive *drives);

// ---- decided.c
// CAU_SESSION_*. Any thread whose event breaks a safety rule makes it CAU_SESSION_FAULTED.
int cau_decided_state(cau_hosted *h);
// A copy of all that is decided but for the queue.
typedef struct cau_decided {
	int state;
	double speed;
	int64_t steps_left;
	int32_t drive_count;
	char fault[sizeof((cau_logic *)0)->fault];
} cau_decided;
cau_decided cau_decided_now(cau_hosted *h);

// ---- advance.c
// session.advance has made its ticks, or lock-step has ended. Takes the order.
void cau_advance_answer(cau_hosted *h, cau_order *order);

// ---- observe.c
// Whether it can be answered. Errors: CAU_BAD_VALUE, CAU_LIMIT.
cau_status cau_advance_check(const cau_hosted *h, const cau_advance *advance, cau_error *error);
// The answer of now; malloc'ed, NULL on failure.
char *cau_advance_text(cau_hosted *h, const cau_order *order, size_t *bytes, cau_error *error);

// ---- apply.c: what each order does. Takes the order if it is done or answered.
cau_outcome_kind cau_hosted_apply(cau_hosted *h, cau_order *order, const cau_action *action);

// ---- what CAU_ORDER_TABLE names (order.h), in the file that each belongs to. Each takes the
// order. cau_apply_pause may get none: it was answered when it came.
typedef cau_outcome_kind cau_applied(cau_hosted *h, cau_order *order, const cau_action *action);
typedef void cau_served(cau_hosted *h, cau_order *order);
#define CHANGE(kind, ask, apply) cau_applied apply;
#define READ(kind, apply) cau_served apply;
CAU_ORDER_TABLE(CHANGE, READ)
#undef CHANGE
#undef READ

// ---- looks.c: who looks at past ticks
// Gives up what a client asked for, or who will not come back.
void cau_looks_give_up(cau_hosted *h, uint32_t client);
// When a core that nobody looks at the past with is to go; INFINITY: there is none.
double cau_looks_due_s(cau_hosted *h);
void cau_looks_finish(cau_looks *looks); // takes NULL

// ---- frame_at.c
// Lets it go, if it is time.
void cau_looks_tire(cau_hosted *h, double now_s);

// ---- back.c
// Lets the builder have a session whose slice has ended, to go back or to stand still. From here on
// it is the builder's.
void cau_back_leave(cau_hosted *h);

// ---- time.c: orders about time and history
// session.step has made its ticks, or the session faulted within them.
void cau_time_stepped(cau_hosted *h, cau_order *order, bool failed);
// The session goes, and with it its rows if it is stored, in the batch of this slice. False: there
// is no memory for it. Answers the order, which it takes.
bool cau_hosted_destroy(cau_hosted *h, cau_order *order, bool stored);
const cau_named_snapshot *cau_snapshot_find(const cau_hosted *h, const char *name);

// ---- drivers.c: what clients are told of drivers and energy
void cau_drive_tell(cau_hosted *h, const cau_drive *drive); // tool.driver_changed
void cau_drive_describe(const cau_drive *drive, cau_wire_driver *driver);
// Counts a refused motion; told once a second by cau_drive_tell_refusals.
void cau_drive_refuse(cau_hosted *h, const cau_order *order, const cau_error *error);
void cau_drive_tell_refusals(cau_hosted *h, double now_s);

// ---- drive.c: what the core and the log are told of them
// Energy off and the tool where it is, as was decided.
void cau_drive_do_cut(cau_hosted *h, const cau_action *action);
// Does an off or a hold, which cannot fail. False: the command is another.
bool cau_drive_does(cau_hosted *h, const cau_command *command);
// Energy off by the daemon itself, in the log for nobody.
void cau_drive_darken(cau_hosted *h, const char *tool);

// ---- shown.c
// What a core shows of its tick; the sample points into the rest, and into the core.
typedef struct cau_shown {
	cau_frame frame;
	cau_stream_tool tools[CAU_MAX_TOOLS]; // without drivers
	cau_stream_statistics statistics;
	cau_stream_sample sample;
} cau_shown;
void cau_show(const cau_session *core, cau_shown *shown);

// ---- frames.c: the session's side of its streams
void cau_frames_publish(cau_hosted *h, double now_s); // those that are due
void cau_frames_restart(cau_hosted *h);               // a new epoch
cau_stream_shape cau_frames_shape(const cau_session_info *info);

// ---- times.c: what is measured of all sessions
void cau_times_stepped(cau_hosted *h, const cau_statistics *statistics); // after each step
// The core has taken the order's command.
void cau_times_applied(cau_hosted *h, const cau_order *order);
// A slice has published what was due; `made`: a frame.
void cau_times_published(cau_hosted *h, bool made);

// ---- record.c: the store
cau_store_batch *cau_record_batch(cau_hosted *h); // of this slice; NULL if memory ran out
// Whether a command can be logged at this tick. The log of a tick has no gap before an entry, so
// that a restart finds room for each acknowledged command. After a loss the log starts again at a
// checkpoint. This call makes the checkpoint, unless the core has commands of this tick already:
// then it returns CAU_IO, and a paused session must be stepped first.
cau_status cau_record_check(cau_hosted *h, cau_error *error);
// Logs a command that the core has taken, with the answer to its request if `order` has one.
void cau_record_command(cau_hosted *h, const cau_command *command, const cau_order *order,
                        const char *text, size_t text_bytes);
// Records an answer that is no command's.
void cau_record_answer(cau_hosted *h, const cau_order *order, const char *text, size_t text_bytes);
void cau_record_state(cau_hosted *h);
void cau_record_checkpoint(cau_hosted *h, uint64_t *hash, size_t *bytes);
// Lets a restart come back to the tick of now: by a row of the log, or by a checkpoint.
void cau_record_reached(cau_hosted *h);
// Makes a checkpoint if that is due by the ticks since the last one, or the log is not whole. True:
// it did.
bool cau_record_far(cau_hosted *h);
// Has the store keep the state of this tick, and its events.
void cau_record_mark(cau_hosted *h);
void cau_record_event(cau_hosted *h, const cau_wire_timeline_event *event, cau_log_level level);
// Answers once what is recorded so far is on the disk. Takes `text`.
void cau_record_reply(cau_hosted *h, const cau_reply *reply, char *text, size_t text_bytes);
void cau_record_commit(cau_hosted *h); // submits the slice's batch
// The stored answer of a resent request: CAU_OK (answered), CAU_NOT_FOUND (act), CAU_BAD_STATE
// (wait), CAU_ALREADY_EXISTS (acted upon, and the answer is not kept any more).
cau_status cau_record_resend(cau_hosted *h, const cau_order *order, cau_error *error);

// ---- read_queue.c: requests that only read
bool cau_reads_are(const cau_order *order);
bool cau_reads_make_file(const cau_order *order);
// Like cau_hosted_submit, for those.
cau_status cau_reads_submit(cau_hosted *h, cau_order *order, cau_error *error);
// How many wait. Noted before a slice takes the drivers' queue, so that each is served after all
// commands that came before it.
int32_t cau_reads_note(cau_hosted *h);
// The first of the `*noted` oldest that can be served now, NULL: none; counts down those it looked
// at.
cau_order *cau_reads_take(cau_hosted *h, int32_t *noted);
bool cau_reads_wait(cau_hosted *h);   // some can be served now
void cau_reads_refuse(cau_hosted *h); // all, of a session that has ended

// ---- export.c
uint32_t cau_export_number(void); // of the next file

// ---- reads.c
// Serves some of the `noted` oldest.
void cau_reads_serve(cau_hosted *h, int32_t noted);

// ---- read_jobs.c
// What the builder needs for an answer; its thread must look at nothing of the session that steps
// change.
typedef struct cau_read_job {
	cau_hosted *hosted;
	cau_order *order;
	uint64_t tick; // of the slice that handed it over
	int64_t branch;
	void *copy;
} cau_read_job;
typedef void cau_read_work(cau_read_job *job); // answers the order, which is not its to free
// Leaves an order to the builder, whose thread does `work` and then, also without having done it,
// `finish` (may be NULL) with the copy. Takes order and copy.
void cau_reads_hand_over(cau_hosted *h, cau_order *order, cau_read_work *work, void *copy,
                         void (*finish)(void *copy), double expected_s);

// ---- answer.c
void cau_answer_fail(cau_order *order, const cau_error *error, int32_t code);
// Sends a notification.
void cau_answer_notify(cau_hosted *h, cau_audience audience, cau_method method, const void *params);

// ---- reply.c
// Answers at once, or after the commit if the method changes something. Takes the order.
void cau_answer_order(cau_hosted *h, cau_order *order, const void *result);
// Looks whether the order was sent before; answers it if so.
cau_outcome_kind cau_hosted_look(cau_hosted *h, cau_order *order);
// Tells of a change of the session. `client` may be NULL or "".
void cau_answer_changed(cau_hosted *h, int change, const char *client);
char *cau_answer_description(cau_hosted *h, cau_method method, size_t *bytes, cau_error *error);

// ---- event.c
void cau_event_add(cau_hosted *h, int kind, const char *tool, const char *client, int64_t count,
                   const char *detail);
void cau_event_end_cut(cau_hosted *h); // before a session rests or goes elsewhere
void cau_event_settle(cau_hosted *h);
// Takes what the core has cut, and its vessels, as reported: after a replay or a rewind.
void cau_event_know_tissue(cau_hosted *h); // after each step
void cau_events_load(cau_hosted *h);       // from the store: of the present branch up to the tick
typedef struct cau_event_page {
	cau_wire_timeline_event *events; // newest first while it is read
	int32_t count, capacity;
} cau_event_page;
// The newest on the branch's line from `from_tick` up to `to_tick`, the oldest of them first.
cau_status cau_events_read(const cau_hosted *h, int64_t branch, uint64_t from_tick,
                           uint64_t to_tick, cau_event_page *taken, cau_error *error);
// Numerical trouble outside a step. The session is faulted; everybody is told.
void cau_hosted_fault(cau_hosted *h, const cau_error *error);
void cau_hosted_tell_fault(cau_hosted *h, const cau_error *error);

// Logs what became of the mesh files of a scene that was built: one line for each line of a report.
// report: of each mesh, or NULL.
void cau_mesh_log(const char *session, const cau_scene_def *scene, const cau_mesh_report *report);
