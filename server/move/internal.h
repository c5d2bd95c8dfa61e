// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share.
//
// Locks: the moves' lock is taken inside no other lock. Of the hub, only cau_hub_make_incoming,
// cau_hub_find and cau_hub_count are called under it. The last two take the hub's lock for a look
// at its list, so that a session is seen either as arriving or as the hub's. Functions of sessions,
// the store and the builder, and answers to couriers, are called under it: none of them waits or
// calls back.
//
// An arrival has an owner while `writing` (the request or commit that set it) and while `accepting`
// is set (that acceptance, until its job has ended). The owner may keep the arrival and read it
// without the lock, but for its core. cau_arrival_take_out checks that there is none.
#pragma once

#include <pthread.h>

#include "clock/clock.h"
#include "hub/moving.h"
#include "log/log.h"
#include "move/courier.h"
#include "move/move.h"
#include "session/handover.h"
#include "store/dump.h"

// Where a session is that has moved away.
typedef struct cau_tombstone {
	char id[CAU_NAME_BYTES], move[CAU_NAME_BYTES];
	cau_moved_to to;
	char proof[CAU_PROOF_BYTES];
} cau_tombstone;

// A session that leaves for another daemon.
typedef struct cau_departure {
	struct cau_departure *next;
	cau_leaving leaving;
	cau_hosted *hosted; // shared
	char id[CAU_NAME_BYTES], label[CAU_NAME_BYTES];
	cau_tombstone becomes;
	cau_move_hash lock, unlock, release;
	cau_move_hash seal; // of the pieces that were read
	cau_store_dump *dump;
	uint32_t pieces;
	bool part_sent, rest_begun, all_sent;
	bool reading; // a job of the mover has the dump
	bool over;    // not in the list any more: whoever has the dump frees it
	double touched_s, held_s;
	cau_reply waiting; // for the disk
} cau_departure;

// Who drove a tool, and may come back to it here.
typedef struct cau_arrival_hand {
	char tool[CAU_NAME_BYTES];
	cau_client client;
} cau_arrival_hand;

// An acceptance, from its commit to the end of the job that places the session (arrival_end.c).
typedef struct cau_accepting cau_accepting;

// A session that comes from another daemon.
typedef struct cau_arrival {
	struct cau_arrival *next;
	cau_coming coming;
	char id[CAU_NAME_BYTES], move[CAU_NAME_BYTES], source[CAU_NAME_BYTES], label[CAU_NAME_BYTES];
	cau_move_hash lock, unlock;
	cau_move_hash seal; // of the pieces that are here
	int64_t pieces;
	bool writing;             // a piece, or what becomes of it, is on its way to the disk
	bool forgotten;           // only its core is still to be cleared away
	cau_accepting *accepting; // owns the arrival; NULL: none does
	cau_hosted *hosted;       // that is built, or waits; NULL: none
	bool ready;               // it waits
	cau_wire_move_held stands;
	cau_arrival_hand hands[CAU_MAX_TOOLS];
	int32_t hand_count;
	double speed;
} cau_arrival;

struct cau_moves {
	cau_moves_def def;
	pthread_mutex_t mutex; // guards what follows
	cau_departure *departures;
	cau_arrival *arrivals;
	cau_move_hash secret;      // of the store
	cau_tombstone *tombstones; // by id
	int32_t tombstone_count, tombstone_capacity;
	bool ends; // the daemon ends: no move is begun or goes on
};

// One request of a courier, on the mover.
typedef struct cau_move_job {
	cau_job job; // first
	cau_moves *moves;
	cau_move_asked asked;
	cau_reply reply;
} cau_move_job;

// ---- courier.c: answers to a courier
void cau_move_fail(const cau_reply *reply, cau_status status, int32_t code, const char *path,
                   const char *reason);
void cau_move_answer(const cau_reply *reply, const void *result);
void cau_move_decided(const cau_reply *reply, const cau_tombstone *moved);
void cau_move_kept(const cau_reply *reply, const char *release);

// ---- tombstones.c
// Of the store, at the start, with its secret.
cau_status cau_tombstones_read(cau_moves *moves, cau_error *error);
// Whether the session has moved away, and where to. Takes the lock.
bool cau_tombstones_have(cau_moves *moves, const char *id, cau_moved_to *to);
// The others: with the lock.
const cau_tombstone *cau_tombstone_find(const cau_moves *moves, const char *id);
// Makes capacity for a tombstone of each move under way. Without it a decided move could not be
// kept in memory, and move.cancel would answer that the session stays. False: no memory.
bool cau_tombstones_reserve(cau_moves *moves);
void cau_tombstone_put(cau_moves *moves, const cau_tombstone *made); // within that capacity
void cau_tombstone_drop(cau_moves *moves, const char *id);
void cau_tombstones_list(const cau_moves *moves, cau_wire_list *list);

// ---- departures.c
void cau_departure_begin(cau_move_job *job);
void cau_departure_read(cau_move_job *job);
void cau_departure_fail_unknown(const cau_reply *reply);
// With the lock. The move that is asked about; NULL: it is not under way here.
cau_departure *cau_departure_find_own(cau_moves *moves, const cau_move_asked *asked);
// With the lock. Out of the list; frees it, or leaves that to whoever reads its rows.
void cau_departure_take_out(cau_moves *moves, cau_departure *departure);
void cau_departures_list(const cau_moves *moves, cau_wire_list *list); // with the lock
void cau_departures_free(cau_moves *moves);

// ---- departure_end.c
void cau_departure_hold(cau_move_job *job);
void cau_departure_commit(cau_move_job *job);
void cau_departure_cancel(cau_move_job *job);
// Those that have stood still for too long, or all of them, go on.
void cau_departures_let_go(cau_moves *moves, double now_s, bool all);

// ---- arrivals.c
// Of the store, at the start.
cau_status cau_arrivals_read(cau_moves *moves, cau_error *error);
// Whether this session has come, in whole or in part, and is not this daemon's yet. Takes the lock.
bool cau_arrivals_have(cau_moves *moves, const char *id);
void cau_arrivals_reap(cau_moves *moves, bool all); // takes the lock
// As the store has it; its strings are the arrival's.
cau_store_arrival cau_arrival_row(const cau_arrival *arrival, int64_t pieces,
                                  cau_store_arrival_state state);
// The others: with the lock.

// CAU_BAD_STATE, and the code to answer with, once the daemon ends: from then on no arrival is
// given to the store or to the builder.
cau_status cau_arrivals_check_open(const cau_moves *moves, int32_t *code, cau_error *error);
// The newest of this id; NULL: there is none. One that was accepted and is served stays in the list
// until the first piece of another move is on the disk.
cau_arrival *cau_arrival_find(cau_moves *moves, const char *id);
// The newest of the move that is asked about.
cau_arrival *cau_arrival_find_own(cau_moves *moves, const cau_move_asked *asked);
// Whether it is not among the hub's sessions yet.
bool cau_arrival_waits(const cau_arrival *arrival);
void cau_arrival_take_out(cau_moves *moves, cau_arrival *arrival); // frees it
void cau_arrivals_list(const cau_moves *moves, cau_wire_list *list);
void cau_arrivals_free(cau_moves *moves);

// ---- arrival_pieces.c
void cau_arrival_receive(cau_move_job *job);

// ---- arrival_end.c
void cau_arrival_ready(cau_move_job *job);
void cau_arrival_accept(cau_move_job *job);
void cau_arrival_forget(cau_move_job *job);
