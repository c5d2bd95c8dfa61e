// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that move between daemons (protocol/README.md, "Moving a session"): those that leave,
// those that arrive, and where the ones are that have left. Jobs of the mover serve the
// requests of a courier. session/handover.h decides.
//
// This room knows the hub. The hub asks it by two functions (hub/moving.h): whether an id has moved
// away, and whether it is on its way here.
#pragma once

#include "builder/builder.h"
#include "config/config.h"
#include "hub/hub.h"
#include "store/store.h"

enum { CAU_PROOF_BYTES = 65 };

typedef struct cau_moves cau_moves;

typedef struct cau_moves_def {
	const cau_config *config; // borrowed, like all here
	cau_store *store;
	cau_builder *mover; // runs the jobs
	cau_hub *hub;
} cau_moves_def;

// ---- for the daemon

// Before the hub has sessions; the hub asks this room from then on.
cau_status cau_moves_create(cau_moves **moves, const cau_moves_def *def, cau_error *error);
// Reads the store's moves. Before cau_hub_resume, which leaves sessions that are on their way here
// in the store.
cau_status cau_moves_resume(cau_moves *moves, cau_error *error);
// Ends moves whose courier has gone, and frees cores of arrivals that have ended. Waits for a
// worker's slice, as cau_hub_reap does, and comes before it.
void cau_moves_reap(cau_moves *moves);
// No move begins or goes on from here; suspended sessions go on. Before cau_hub_drain. Waits for
// the store. Takes NULL.
void cau_moves_drain(cau_moves *moves);
// The same, and ends the cores of arrivals. After cau_builder_stop of the mover, before
// cau_hub_stop. Takes NULL.
void cau_moves_stop(cau_moves *moves);
// After cau_hub_stop, before cau_hub_destroy. Takes NULL.
void cau_moves_destroy(cau_moves *moves);

// ---- for transports

typedef enum {
	CAU_MOVE_BEGIN,
	CAU_MOVE_READ,
	CAU_MOVE_HOLD,
	CAU_MOVE_COMMIT,
	CAU_MOVE_CANCEL,
	CAU_MOVE_RECEIVE,
	CAU_MOVE_READY,
	CAU_MOVE_ACCEPT,
	CAU_MOVE_FORGET,
	CAU_MOVE_LIST,
} cau_move_what;

// A request of a courier.
typedef struct cau_move_asked {
	cau_move_what what;
	char session[CAU_NAME_BYTES], move[CAU_NAME_BYTES];
	cau_moved_to to;            // BEGIN
	char label[CAU_NAME_BYTES]; // BEGIN
	char key[CAU_PROOF_BYTES];  // ACCEPT: proof, COMMIT: receipt, FORGET: release or ""
	bool source_lost;           // FORGET
	unsigned char *piece;       // RECEIVE: malloc'ed, taken
	size_t piece_bytes;
} cau_move_asked;

// Does it, on the mover, and answers through `reply`. Takes the piece, on failure too. Any thread.
cau_status cau_moves_ask(cau_moves *moves, const cau_move_asked *asked, const cau_reply *reply,
                         cau_error *error);
