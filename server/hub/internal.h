// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "clock/clock.h"
#include "hub/hub.h"
#include "hub/move_seals.h"
#include "log/log.h"
#include "session/handover.h"

enum { MOST_SINKS = 4 };

// Sessions that have ended keep their place until they are reaped.
#define SLOTS(config) (2 * (size_t)(config)->max_sessions)

struct cau_hub {
	cau_hub_def def;
	cau_quota *quota;
	_Atomic int64_t memory_held; // by all sessions, bytes, about
	cau_beginnings beginnings;
	cau_surroundings around;
	cau_surroundings around_ephemeral; // the same with the store in memory
	cau_hosted_times times;
	cau_sink sinks[MOST_SINKS];
	int sink_count;

	pthread_mutex_t mutex; // guards what follows; taken before a session's, never inside one
	cau_hosted **sessions;
	int32_t session_count;
	_Atomic uint32_t last_session;
	_Atomic uint32_t last_resumed; // of those that the daemon begins with, which are the first
	cau_client *clients;
	int32_t client_count, client_capacity;
	uint32_t last_client;

	// the clerk: makes sessions, off the network thread since it reads the store
	cau_task clerk; // see clerk.c
	pthread_mutex_t clerk_mutex;
	cau_creation *first, *last;
	uint32_t last_name;

	atomic_bool copying; // a copy of the store is being made

	pthread_mutex_t moves_mutex; // guards what follows; inside no other lock but the hub's
	struct cau_departure *departures;
	struct cau_arrival *arrivals;
	cau_move_hash move_secret;        // of the store
	struct cau_tombstone *tombstones; // by id
	int32_t tombstone_count, tombstone_capacity;
	bool moves_end; // the daemon ends: no move is begun or goes on
};

// ---- clerk.c
cau_due cau_clerk_run(cau_task *task);
// Makes and registers a session; takes the creation.
cau_status cau_clerk_make(cau_hub *hub, cau_creation *creation, const char *id, cau_error *error);
void cau_clerk_fork(void *user, cau_hosted *source, int64_t branch, const cau_order *order);

// ---- discard.c
void cau_clerk_answer_missing(cau_hub *hub, const cau_reply *reply, const char *id);
// Destroys the session `asked->name` of the store, which is not among the hub's; answers.
void cau_clerk_discard(cau_hub *hub, const cau_creation *asked);

// ---- clients.c
// What a client comes back with to its tools. False: it cannot.
bool cau_hub_resume_token(cau_hub *hub, uint32_t number, char token[CAU_RESUME_BYTES]);

// ---- resume.c
// Session `id` of the store, as what is needed to make it; freed by cau_creation_free.
cau_status cau_hub_read_session(cau_hub *hub, const char *id, cau_creation **creation,
                                cau_error *error);
// Brings session `id` of the store up; answers `reply` (may be of nobody) with its description.
cau_status cau_hub_resume_one(cau_hub *hub, const char *id, const cau_reply *reply,
                              cau_error *error);

// ---- moved.c: sessions that have moved away, and those that are on their way here
typedef struct cau_tombstone {
	char id[CAU_NAME_BYTES], move[CAU_NAME_BYTES];
	cau_moved_to to;
	char proof[CAU_PROOF_BYTES];
} cau_tombstone;
// Of the store, at the start.
cau_status cau_tombstones_read(cau_hub *hub, cau_error *error);
// All four: with the moves' lock.
const cau_tombstone *cau_tombstone_find(const cau_hub *hub, const char *id);
// Makes capacity for a tombstone of each move under way. Without it a decided move could not be
// kept in memory, and move.cancel would answer that the session stays. False: no memory.
bool cau_tombstones_reserve(cau_hub *hub);
void cau_tombstone_put(cau_hub *hub, const cau_tombstone *made); // within the reserved capacity
void cau_tombstone_drop(cau_hub *hub, const char *id);

// Who drove a tool, and may come back to it here.
typedef struct cau_arrival_hand {
	char tool[CAU_NAME_BYTES];
	cau_client client;
} cau_arrival_hand;

typedef struct cau_arrival {
	struct cau_arrival *next;
	cau_coming coming;
	char id[CAU_NAME_BYTES], move[CAU_NAME_BYTES], source[CAU_NAME_BYTES], label[CAU_NAME_BYTES];
	cau_move_hash lock, unlock;
	cau_move_hash seal; // of the pieces that are here
	int64_t pieces;
	bool writing;       // a piece, or what becomes of it, is on its way to the disk
	bool forgotten;     // only its core is still to be cleared away
	cau_hosted *hosted; // that is built, or waits; NULL: none
	bool ready;         // it waits
	cau_wire_move_held stands;
	cau_arrival_hand hands[CAU_MAX_TOOLS];
	int32_t hand_count;
	double speed;
} cau_arrival;
// Of the store, at the start.
cau_status cau_arrivals_read(cau_hub *hub, cau_error *error);
cau_arrival *cau_arrival_find(cau_hub *hub, const char *id); // with the lock; NULL: there is none
// Whether this session has come, in whole or in part, and is not this daemon's yet.
bool cau_arrivals_have(cau_hub *hub, const char *id);

// ---- move_answers.c
void cau_move_fail(const cau_reply *reply, cau_status status, int32_t code, const char *path,
                   const char *reason);
void cau_move_answer(const cau_reply *reply, const void *result);
void cau_move_decided(const cau_reply *reply, const cau_tombstone *moved);
void cau_move_kept(const cau_reply *reply, const char *release);
// ---- moves.c
// One request about a move, on the mover.
typedef struct cau_move_job {
	cau_job job; // first
	cau_hub *hub;
	cau_move_asked asked;
	cau_reply reply;
} cau_move_job;

// ---- departures.c
void cau_departure_begin(cau_move_job *job);
void cau_departure_read(cau_move_job *job);
void cau_departures_list(cau_hub *hub, cau_wire_list *list); // with the moves' lock
void cau_departures_free(cau_hub *hub);

// ---- departure_end.c
void cau_departure_hold(cau_move_job *job);
void cau_departure_commit(cau_move_job *job);
void cau_departure_cancel(cau_move_job *job);
// Those that have stood still for too long, or all of them, go on.
void cau_departures_let_go(cau_hub *hub, double now_s, bool all);

// ---- arrival_pieces.c
void cau_arrival_receive(cau_move_job *job);

// ---- arrivals.c
void cau_arrival_take_out(cau_hub *hub, cau_arrival *arrival); // with the lock; frees it
// As the store has it; its strings are the arrival's.
cau_store_arrival cau_arrival_row(const cau_arrival *arrival, int64_t pieces,
                                  cau_store_arrival_state state);
void cau_arrival_ready(cau_move_job *job);
void cau_arrival_accept(cau_move_job *job);
void cau_arrival_forget(cau_move_job *job);
void cau_arrivals_list(cau_hub *hub, cau_wire_list *list); // with the moves' lock
void cau_arrivals_reap(cau_hub *hub, bool all);
void cau_arrivals_free(cau_hub *hub);
