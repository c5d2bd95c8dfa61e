// SPDX-License-Identifier: GPL-3.0-or-later
// Which daemon serves a session that moves: the decisions of the source daemon, which the session
// leaves, and of the target daemon, which it reaches. These are pure state machines, without clock,
// store or messages. The caller reports each event, and carries out the one act that is returned.
//
// The two daemons never talk to each other. A courier carries their messages. It may die at any
// time, and another courier may continue. The decision is one row in the source's store, the
// tombstone. It is written in the transaction that removes the session, and holds the proof. Only
// this proof opens the lock that the target has. So:
//     at most one daemon serves: the source shows the proof only once the row is on the disk, and
//         then serves no more; the target serves only after it has seen the proof;
//     one daemon serves in the end: once the row exists, any courier can take the proof to the
//         target; without the row the source continues and states that this move will never happen,
//         so that the target may forget the session. A proof that was not written exists only in
//         the source's memory, and is lost with that memory.
#pragma once

#include <stdbool.h>

// ---- the source daemon
typedef enum cau_leaving_state {
	CAU_LEAVING_NOT,      // the session is served; no move is under way
	CAU_LEAVING_SENDS,    // the session is served; its existing rows are sent meanwhile
	CAU_LEAVING_STOPS,    // the session is about to be suspended
	CAU_LEAVING_HELD,     // the session is suspended, energy off; the remaining rows are sent
	CAU_LEAVING_DECIDING, // the tombstone is being written to the disk
	// the disk refused the tombstone: it may still appear on the disk, until another commit
	// succeeds
	CAU_LEAVING_DOUBTS,
	// another commit is being written, after which the tombstone cannot appear
	CAU_LEAVING_CLEARING,
	CAU_LEAVING_GONE, // the tombstone is on the disk
} cau_leaving_state;

typedef enum cau_leaving_event {
	CAU_LEAVING_BEGIN,   // a courier begins a new move
	CAU_LEAVING_HOLD,    // the courier asks to suspend the session
	CAU_LEAVING_STOPPED, // the session is suspended, and its whole state is on the disk
	CAU_LEAVING_NOT_STOPPED,
	CAU_LEAVING_COMMIT,  // the courier has shown the target's receipt for all pieces
	CAU_LEAVING_WRITTEN, // the tombstone, or the other commit, is on the disk
	CAU_LEAVING_REFUSED, // the disk refused the write
	CAU_LEAVING_UNSENT,  // the store did not accept the batch, so nothing was written
	CAU_LEAVING_CANCEL,  // the courier cancels the move
	CAU_LEAVING_LATE,    // the session was suspended for too long, or the daemon ends
} cau_leaving_event;

typedef enum cau_leaving_act {
	CAU_LEAVING_REFUSE,  // refuse: the event is not possible in this state
	CAU_LEAVING_NOTHING, // do nothing: the state is already so, or an answer follows later
	CAU_LEAVING_DO_BEGIN,
	CAU_LEAVING_DO_STOP,
	CAU_LEAVING_SAY_HELD,
	CAU_LEAVING_DO_WRITE, // write the tombstone
	CAU_LEAVING_DO_CLEAR, // commit anything else, so that the tombstone cannot appear on the disk
	CAU_LEAVING_DO_GO_ON, // forget the proof; resume the session if it is suspended
	CAU_LEAVING_DO_END,   // end the session here; the proof may be shown
	CAU_LEAVING_SHOW,     // show the proof again
	CAU_LEAVING_SAY_KEPT, // answer that no such move exists or will exist
} cau_leaving_act;

typedef struct cau_leaving {
	cau_leaving_state state;
	bool cancelled; // a cancel came that must wait for the present write or suspension
	bool doubtful;  // the disk refused a tombstone that may still appear
} cau_leaving;

// Takes one event and returns the act to carry out. `own`: the event belongs to the present move,
// or to the move of the tombstone. Only events of a courier can belong to another move.
cau_leaving_act cau_leaving_take(cau_leaving *leaving, cau_leaving_event event, bool own);
// True if the source may compute ticks of the session.
bool cau_leaving_serves(const cau_leaving *leaving);
// Returns the state after a restart. Everything except the tombstone is forgotten.
cau_leaving cau_leaving_after_restart(bool tombstone);

// ---- the target daemon
typedef enum cau_coming_state {
	CAU_COMING_NOT,
	CAU_COMING_INCOMING, // pieces are missing
	CAU_COMING_WHOLE, // all rows are on the disk; the session is in doubt until the proof is seen
	CAU_COMING_ACCEPTING, // the proof was seen, and the acceptance is being written to the disk
	CAU_COMING_HERE,      // this daemon serves the session
} cau_coming_state;

typedef enum cau_coming_event {
	CAU_COMING_PIECE, // a piece is on the disk
	CAU_COMING_LAST,  // the last piece is on the disk
	CAU_COMING_PROOF, // the courier has shown a proof that opens the lock
	CAU_COMING_WRITTEN,
	CAU_COMING_REFUSED, // the disk refused the write
	CAU_COMING_FORGET,  // the courier has shown the source's release
} cau_coming_event;

typedef enum cau_coming_act {
	CAU_COMING_REFUSE,
	CAU_COMING_NOTHING,
	CAU_COMING_DO_WRITE, // write the acceptance
	CAU_COMING_DO_SERVE,
	CAU_COMING_SAY_HERE, // answer that the session was accepted before
	CAU_COMING_DO_FORGET,
} cau_coming_act;

typedef struct cau_coming {
	cau_coming_state state;
} cau_coming;

// Takes one event and returns the act to carry out. `own`: the event belongs to the move that is
// known here.
cau_coming_act cau_coming_take(cau_coming *coming, cau_coming_event event, bool own);
bool cau_coming_serves(const cau_coming *coming);
// Returns the state after a restart. `whole` and `accepted` are as in the store.
cau_coming cau_coming_after_restart(bool known, bool whole, bool accepted);
