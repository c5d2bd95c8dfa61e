// SPDX-License-Identifier: GPL-3.0-or-later
// Declarations that the files of this folder share.
//
// Locks: the lock of cau_moves is taken inside no other lock. Of the hub, only
// cau_hub_make_incoming, cau_hub_find and cau_hub_count are called under it. The last two take the
// hub's lock to search its list, so that a session is seen either as arriving or as the hub's.
// Functions of sessions, the store and the builder, and answers to couriers, are called under it:
// none of them waits or calls back.
//
// An arrival has an owner in two cases. While `writing` is set, the owner is the request or commit
// that set `writing`. While `accepting` is set, the owner is that acceptance, until the job of the
// acceptance has ended. The owner may keep the arrival and read it without the lock, except the
// arrival's `hosted`. cau_arrival_take_out checks that there is no owner.
#pragma once

#include <pthread.h>

#include "clock/clock.h"
#include "hub/hub.h"
#include "log/log.h"
#include "move/courier.h"
#include "move/move.h"
#include "session/handover.h"
#include "store/rows.h"

// Where to find a session that has moved away, and the proof of the move.
typedef struct cau_tombstone {
	char id[CAU_NAME_BYTES], move[CAU_NAME_BYTES];
	cau_moved_to to;
	char proof[CAU_PROOF_BYTES];
} cau_tombstone;

// A session that leaves for another daemon.
typedef struct cau_departure {
	struct cau_departure *next;
	cau_leaving leaving;
	cau_hosted *hosted; // with a reference
	char id[CAU_NAME_BYTES], label[CAU_NAME_BYTES];
	cau_tombstone becomes;
	cau_move_hash lock, unlock, release;
	cau_move_hash seal; // seal of the last piece that was read
	cau_store_dump *dump;
	uint32_t pieces;
	bool part_sent, rest_begun, all_sent;
	bool reading; // a job of the mover uses `dump`
	bool over;    // the departure is no longer in the list; the job that uses `dump` frees it
	double touched_s, held_s;
	cau_reply waiting; // reply to a request that waits for the disk
} cau_departure;

// A client that drove a tool at the source. The client may return here and get the tool.
typedef struct cau_arrival_hand {
	char tool[CAU_NAME_BYTES];
	cau_client client;
} cau_arrival_hand;

// An acceptance, from its commit to the end of the job that adds the session to the hub
// (arrival_end.c).
typedef struct cau_accepting cau_accepting;

// A session that arrives from another daemon.
typedef struct cau_arrival {
	struct cau_arrival *next;
	cau_coming coming;
	char id[CAU_NAME_BYTES], move[CAU_NAME_BYTES], source[CAU_NAME_BYTES], label[CAU_NAME_BYTES];
	cau_move_hash lock, unlock;
	cau_move_hash seal; // seal of the last piece on the disk
	int64_t pieces;
	bool writing;             // a commit about this arrival is on its way to the disk
	bool forgotten;           // the arrival was forgotten; only its core must still be freed
	cau_accepting *accepting; // owner of the arrival; NULL: none
	cau_hosted *hosted;       // the session that is being built or is ready; NULL: none
	bool ready;               // `hosted` is built and waits to be accepted
	cau_wire_move_held stands;
	cau_arrival_hand hands[CAU_MAX_TOOLS];
	int32_t hand_count;
	double speed;
} cau_arrival;

struct cau_moves {
	cau_moves_def def;
	pthread_mutex_t mutex; // guards the members below
	cau_departure *departures;
	cau_arrival *arrivals;
	cau_move_hash secret;      // the store's secret, from which releases are made
	cau_tombstone *tombstones; // sorted by id
	int32_t tombstone_count, tombstone_capacity;
	bool ends; // the daemon ends: no move begins or continues
};

// One request of a courier, as a job of the mover.
typedef struct cau_move_job {
	cau_job job; // must be the first member
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
// Reads the tombstones and the secret of the store at the start.
cau_status cau_tombstones_read(cau_moves *moves, cau_error *error);
// True if the session has moved away; *to is then its target. Takes the lock.
bool cau_tombstones_have(cau_moves *moves, const char *id, cau_moved_to *to);
// The functions below are called with the lock.
const cau_tombstone *cau_tombstone_find(const cau_moves *moves, const char *id);
// Allocates capacity for a tombstone of each move under way. Without it a decided move could not be
// kept in memory, and move.cancel would answer that the session stays. Returns false if memory runs
// out.
bool cau_tombstones_reserve(cau_moves *moves);
// Adds a tombstone. cau_tombstones_reserve has allocated the capacity for it.
void cau_tombstone_put(cau_moves *moves, const cau_tombstone *made);
void cau_tombstone_drop(cau_moves *moves, const char *id);
void cau_tombstones_list(const cau_moves *moves, cau_wire_list *list);

// ---- departures.c
void cau_departure_begin(cau_move_job *job);
void cau_departure_read(cau_move_job *job);
void cau_departure_fail_unknown(const cau_reply *reply);
// Called with the lock. Returns the departure of this move, or NULL if the move is not under way
// here.
cau_departure *cau_departure_find_own(cau_moves *moves, const cau_move_asked *asked);
// Called with the lock. Removes the departure from the list and frees it. If a job is reading the
// departure's rows, this job frees the departure.
void cau_departure_take_out(cau_moves *moves, cau_departure *departure);
void cau_departures_list(const cau_moves *moves, cau_wire_list *list); // called with the lock
void cau_departures_free(cau_moves *moves);

// ---- departure_end.c
void cau_departure_hold(cau_move_job *job);
void cau_departure_commit(cau_move_job *job);
void cau_departure_cancel(cau_move_job *job);
// Resumes the sessions that have been suspended for too long, or all (`all`).
void cau_departures_let_go(cau_moves *moves, double now_s, bool all);

// ---- arrivals.c
// Reads the arrivals of the store at the start.
cau_status cau_arrivals_read(cau_moves *moves, cau_error *error);
// True if rows of this session have arrived and this daemon does not serve it yet. Takes the lock.
bool cau_arrivals_have(cau_moves *moves, const char *id);
void cau_arrivals_reap(cau_moves *moves, bool all); // takes the lock
// Returns the arrival's row for the store. Its strings belong to the arrival.
cau_store_arrival cau_arrival_row(const cau_arrival *arrival, int64_t pieces,
                                  cau_store_arrival_state state);
// The functions below are called with the lock.

// Returns CAU_BAD_STATE and the code of the answer once the daemon ends. From then on no arrival is
// handed to the store or the builder.
cau_status cau_arrivals_check_open(const cau_moves *moves, int32_t *code, cau_error *error);
// Returns the newest arrival of this session, or NULL. An accepted arrival stays in the list until
// the first piece of another move is on the disk.
cau_arrival *cau_arrival_find(cau_moves *moves, const char *id);
// Returns the newest arrival of this move, or NULL.
cau_arrival *cau_arrival_find_own(cau_moves *moves, const cau_move_asked *asked);
// True if the session is not among the hub's sessions yet.
bool cau_arrival_waits(const cau_arrival *arrival);
void cau_arrival_take_out(cau_moves *moves, cau_arrival *arrival); // also frees the arrival
void cau_arrivals_list(const cau_moves *moves, cau_wire_list *list);
void cau_arrivals_free(cau_moves *moves);

// ---- arrival_pieces.c
void cau_arrival_receive(cau_move_job *job);

// ---- arrival_end.c
void cau_arrival_ready(cau_move_job *job);
void cau_arrival_accept(cau_move_job *job);
void cau_arrival_forget(cau_move_job *job);
