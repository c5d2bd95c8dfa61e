// SPDX-License-Identifier: GPL-3.0-or-later
// Moves of sessions between daemons (protocol/README.md, "Moving a session"): sessions that leave,
// sessions that arrive, and the targets of sessions that have left. The requests of a courier are
// served by jobs of the mover. session/handover.h makes the decisions.
//
// This folder uses the hub. The hub calls two functions of this folder (hub/hub.h): whether an
// id has moved away, and whether it is arriving.
#pragma once

#include "builder/builder.h"
#include "config/config.h"
#include "hub/hub.h"
#include "store/store.h"

enum { CAU_PROOF_BYTES = 65 };

typedef struct cau_moves cau_moves;

typedef struct cau_moves_def {
	const cau_config *config; // borrowed, as are the other members
	cau_store *store;
	cau_builder *mover; // runs the jobs
	cau_hub *hub;
} cau_moves_def;

// ---- for the daemon

// Call this before the hub has sessions. From then on the hub calls functions of this folder.
cau_status cau_moves_create(cau_moves **moves, const cau_moves_def *def, cau_error *error);
// Reads the moves of the store. Call this before cau_hub_resume, which does not resume sessions
// that are still arriving.
cau_status cau_moves_resume(cau_moves *moves, cau_error *error);
// Ends moves whose courier is gone, and frees cores of arrivals that have ended. Like cau_hub_reap,
// it waits for a worker's slice. Call it before cau_hub_reap.
void cau_moves_reap(cau_moves *moves);
// Ends all moves: no move begins or continues from here on, and suspended sessions resume. Waits
// for the store. Call this before cau_hub_drain. `moves` may be NULL.
void cau_moves_drain(cau_moves *moves);
// Ends all moves as cau_moves_drain does, and frees the cores of arrivals. Call this after
// cau_builder_stop of the mover and before cau_hub_stop. `moves` may be NULL.
void cau_moves_stop(cau_moves *moves);
// Call this after cau_hub_stop and before cau_hub_destroy. `moves` may be NULL.
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
	cau_moved_to to;            // for BEGIN
	char label[CAU_NAME_BYTES]; // for BEGIN: label of the target
	// for ACCEPT: the proof; COMMIT: the receipt; FORGET: the release or ""
	char key[CAU_PROOF_BYTES];
	bool source_lost;     // for FORGET: the source is lost for good
	unsigned char *piece; // for RECEIVE: malloc'ed; ownership is taken
	size_t piece_bytes;
} cau_move_asked;

// Serves the request on the mover, and answers through `reply`. Takes ownership of the piece, even
// on failure. Any thread may call this.
cau_status cau_moves_ask(cau_moves *moves, const cau_move_asked *asked, const cau_reply *reply,
                         cau_error *error);
