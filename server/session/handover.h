// SPDX-License-Identifier: GPL-3.0-or-later
// Who serves a session that moves: the decisions of the daemon that it leaves and of the one that
// it comes to. Pure: no clock, store or message in it; whoever holds a machine tells it what
// happened and does the one thing that it answers.
//
// The two never talk to each other. A courier carries what they say, may die anywhere, and may be
// another one the next time. What decides is one row in the source's store, the tombstone: it is
// written in the transaction that takes the session out, and holds the proof that alone opens the
// lock that the target has. So:
//     at most one serves: the source shows the proof only once the row is on the disk, and then
//         serves no more; the target serves only after it has seen the proof;
//     one serves in the end: with the row there, any courier takes the proof to the target; without
//         it the source goes on, and says that this move will never be, so that the target may
//         forget. A proof that was not written is in the source's memory alone, and goes with it.
#pragma once

#include <stdbool.h>

// ---- the daemon that a session leaves
typedef enum cau_leaving_state {
	CAU_LEAVING_NOT,      // it is served, and nobody moves it
	CAU_LEAVING_SENDS,    // it is served; what is there goes out meanwhile
	CAU_LEAVING_STOPS,    // it is about to stand still
	CAU_LEAVING_HELD,     // it stands still, dark; the rest goes out
	CAU_LEAVING_DECIDING, // the tombstone is on its way to the disk
	CAU_LEAVING_DOUBTS,   // the disk refused it: it may come to light yet, until another commit
	CAU_LEAVING_CLEARING, // that other commit is on its way
	CAU_LEAVING_GONE,     // the tombstone is there
} cau_leaving_state;

typedef enum cau_leaving_event {
	CAU_LEAVING_BEGIN,   // of a new move
	CAU_LEAVING_HOLD,    // asked for by the courier
	CAU_LEAVING_STOPPED, // it stands still, all that it was is on the disk
	CAU_LEAVING_NOT_STOPPED,
	CAU_LEAVING_COMMIT,  // the courier has shown the target's receipt for all pieces
	CAU_LEAVING_WRITTEN, // the tombstone, or the other commit
	CAU_LEAVING_REFUSED, // by the disk
	CAU_LEAVING_UNSENT,  // the store did not even take it: nothing was written
	CAU_LEAVING_CANCEL,  // asked for by the courier
	CAU_LEAVING_LATE,    // it has stood still for too long, or the daemon ends
} cau_leaving_event;

typedef enum cau_leaving_act {
	CAU_LEAVING_REFUSE,  // this cannot be now
	CAU_LEAVING_NOTHING, // it is so already, or will be told
	CAU_LEAVING_DO_BEGIN,
	CAU_LEAVING_DO_STOP,
	CAU_LEAVING_SAY_HELD,
	CAU_LEAVING_DO_WRITE, // the tombstone
	CAU_LEAVING_DO_CLEAR, // write anything else, so that the tombstone cannot come to light
	CAU_LEAVING_DO_GO_ON, // forget the proof; the session is served on if it stood still
	CAU_LEAVING_DO_END,   // the session ends here; the proof may be shown
	CAU_LEAVING_SHOW,     // the proof, again
	CAU_LEAVING_SAY_KEPT, // no such move is or will be
} cau_leaving_act;

typedef struct cau_leaving {
	cau_leaving_state state;
	bool cancelled; // while it could not be heeded at once
	bool doubtful;  // a tombstone that the disk refused may come to light yet
} cau_leaving;

// `own`: the event is about the move that is under way, or that the tombstone tells of. Only the
// courier's events can be about another.
cau_leaving_act cau_leaving_take(cau_leaving *leaving, cau_leaving_event event, bool own);
// Whether the session may be served here: its ticks go on.
bool cau_leaving_serves(const cau_leaving *leaving);
// After a restart: all but the tombstone is forgotten.
cau_leaving cau_leaving_after_restart(bool tombstone);

// ---- the daemon that it comes to
typedef enum cau_coming_state {
	CAU_COMING_NOT,
	CAU_COMING_INCOMING,  // pieces are missing
	CAU_COMING_WHOLE,     // all rows are on the disk: in doubt until the proof is seen
	CAU_COMING_ACCEPTING, // the proof was seen; that is on its way to the disk
	CAU_COMING_HERE,      // it is this daemon's
} cau_coming_state;

typedef enum cau_coming_event {
	CAU_COMING_PIECE, // a piece is on the disk
	CAU_COMING_LAST,  // the last of them is
	CAU_COMING_PROOF, // shown, and it opens the lock
	CAU_COMING_WRITTEN,
	CAU_COMING_REFUSED, // by the disk
	CAU_COMING_FORGET,  // the courier has shown the source's release
} cau_coming_event;

typedef enum cau_coming_act {
	CAU_COMING_REFUSE,
	CAU_COMING_NOTHING,
	CAU_COMING_DO_WRITE, // that it is accepted
	CAU_COMING_DO_SERVE,
	CAU_COMING_SAY_HERE, // it was accepted before
	CAU_COMING_DO_FORGET,
} cau_coming_act;

typedef struct cau_coming {
	cau_coming_state state;
} cau_coming;

// `own`: the event is about the move that is known here.
cau_coming_act cau_coming_take(cau_coming *coming, cau_coming_event event, bool own);
bool cau_coming_serves(const cau_coming *coming);
// After a restart: `whole` and `accepted` as the store has it.
cau_coming cau_coming_after_restart(bool known, bool whole, bool accepted);
