// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/handover.h"

#include "cautery/assert.h"

// ---- the source ---------------------------------------------------------------------------------

static cau_leaving_act go(cau_leaving *leaving, cau_leaving_state state, cau_leaving_act act)
{
	leaving->state = state;
	return act;
}

static cau_leaving_act go_on(cau_leaving *leaving)
{
	leaving->cancelled = false;
	return go(leaving, CAU_LEAVING_NOT, CAU_LEAVING_DO_GO_ON);
}

// Cancels the move. A tombstone that the disk refused may appear after a crash, until another
// commit succeeds. So a cancel then, or while the disk writes the tombstone, takes effect after
// such a commit.
static cau_leaving_act cancel(cau_leaving *leaving)
{
	switch (leaving->state) {
	case CAU_LEAVING_SENDS:
	case CAU_LEAVING_HELD:
		return go_on(leaving);
	case CAU_LEAVING_DOUBTS:
		return go(leaving, CAU_LEAVING_CLEARING, CAU_LEAVING_DO_CLEAR);
	case CAU_LEAVING_STOPS:
	case CAU_LEAVING_DECIDING:
		leaving->cancelled = true;
		return CAU_LEAVING_NOTHING;
	default:
		return CAU_LEAVING_NOTHING;
	}
}

static cau_leaving_act stopped(cau_leaving *leaving)
{
	if (leaving->state != CAU_LEAVING_STOPS)
		return CAU_LEAVING_REFUSE;
	if (leaving->cancelled)
		return go_on(leaving);
	return go(leaving, CAU_LEAVING_HELD, CAU_LEAVING_SAY_HELD);
}

static cau_leaving_act written(cau_leaving *leaving)
{
	leaving->doubtful = false;
	if (leaving->state == CAU_LEAVING_DECIDING)
		return go(leaving, CAU_LEAVING_GONE, CAU_LEAVING_DO_END);
	if (leaving->state == CAU_LEAVING_CLEARING)
		return go_on(leaving);
	return CAU_LEAVING_REFUSE;
}

static cau_leaving_act refused(cau_leaving *leaving)
{
	bool cancelled = leaving->cancelled;
	leaving->state = CAU_LEAVING_DOUBTS;
	leaving->cancelled = false;
	leaving->doubtful = true;
	return cancelled ? cancel(leaving) : CAU_LEAVING_NOTHING;
}

// The store did not accept the batch. A doubt from an earlier write remains, and the courier asks
// again later. Without a doubt there is nothing to clear.
static cau_leaving_act unsent(cau_leaving *leaving)
{
	bool cancelled = leaving->cancelled && !leaving->doubtful;
	leaving->state = leaving->doubtful ? CAU_LEAVING_DOUBTS : CAU_LEAVING_HELD;
	leaving->cancelled = false;
	return cancelled ? cancel(leaving) : CAU_LEAVING_NOTHING;
}

static cau_leaving_act commit(cau_leaving *leaving)
{
	if (leaving->state == CAU_LEAVING_HELD || leaving->state == CAU_LEAVING_DOUBTS)
		return go(leaving, CAU_LEAVING_DECIDING, CAU_LEAVING_DO_WRITE);
	return leaving->state == CAU_LEAVING_GONE ? CAU_LEAVING_SHOW : CAU_LEAVING_REFUSE;
}

// Answers a courier about a move that is not known here. Such a move will never happen: its proof
// was only in memory and is lost.
static cau_leaving_act of_another(const cau_leaving *leaving, cau_leaving_event event)
{
	(void)leaving;
	return event == CAU_LEAVING_CANCEL ? CAU_LEAVING_SAY_KEPT : CAU_LEAVING_REFUSE;
}

cau_leaving_act cau_leaving_take(cau_leaving *leaving, cau_leaving_event event, bool own)
{
	if (event == CAU_LEAVING_BEGIN)
		return leaving->state == CAU_LEAVING_NOT
		           ? go(leaving, CAU_LEAVING_SENDS, CAU_LEAVING_DO_BEGIN)
		           : CAU_LEAVING_REFUSE;
	if (!own || leaving->state == CAU_LEAVING_NOT)
		return of_another(leaving, event);
	switch (event) {
	case CAU_LEAVING_HOLD:
		return leaving->state == CAU_LEAVING_SENDS
		           ? go(leaving, CAU_LEAVING_STOPS, CAU_LEAVING_DO_STOP)
		           : CAU_LEAVING_REFUSE;
	case CAU_LEAVING_STOPPED:
		return stopped(leaving);
	case CAU_LEAVING_NOT_STOPPED:
		return go_on(leaving);
	case CAU_LEAVING_COMMIT:
		return commit(leaving);
	case CAU_LEAVING_WRITTEN:
		return written(leaving);
	case CAU_LEAVING_REFUSED:
		return refused(leaving);
	case CAU_LEAVING_UNSENT:
		return unsent(leaving);
	case CAU_LEAVING_CANCEL:
	case CAU_LEAVING_LATE:
		return leaving->state == CAU_LEAVING_GONE && event == CAU_LEAVING_CANCEL ? CAU_LEAVING_SHOW
		                                                                         : cancel(leaving);
	case CAU_LEAVING_BEGIN:
		break;
	}
	CAU_ASSERT(false, "event %d is none", (int)event);
	return CAU_LEAVING_REFUSE;
}

bool cau_leaving_serves(const cau_leaving *leaving)
{
	return leaving->state == CAU_LEAVING_NOT || leaving->state == CAU_LEAVING_SENDS ||
	       leaving->state == CAU_LEAVING_STOPS;
}

cau_leaving cau_leaving_after_restart(bool tombstone)
{
	return (cau_leaving){.state = tombstone ? CAU_LEAVING_GONE : CAU_LEAVING_NOT};
}

// ---- the target ---------------------------------------------------------------------------------

static cau_coming_act become(cau_coming *coming, cau_coming_state state, cau_coming_act act)
{
	coming->state = state;
	return act;
}

static cau_coming_act take_piece(cau_coming *coming, bool last)
{
	if (coming->state != CAU_COMING_NOT && coming->state != CAU_COMING_INCOMING)
		return CAU_COMING_REFUSE;
	return become(coming, last ? CAU_COMING_WHOLE : CAU_COMING_INCOMING, CAU_COMING_NOTHING);
}

static cau_coming_act take_proof(cau_coming *coming)
{
	switch (coming->state) {
	case CAU_COMING_WHOLE:
		return become(coming, CAU_COMING_ACCEPTING, CAU_COMING_DO_WRITE);
	case CAU_COMING_HERE:
		return CAU_COMING_SAY_HERE;
	default:
		return CAU_COMING_REFUSE;
	}
}

cau_coming_act cau_coming_take(cau_coming *coming, cau_coming_event event, bool own)
{
	if (!own)
		return CAU_COMING_REFUSE;
	switch (event) {
	case CAU_COMING_PIECE:
	case CAU_COMING_LAST:
		return take_piece(coming, event == CAU_COMING_LAST);
	case CAU_COMING_PROOF:
		return take_proof(coming);
	case CAU_COMING_WRITTEN:
		return become(coming, CAU_COMING_HERE, CAU_COMING_DO_SERVE);
	case CAU_COMING_REFUSED:
		return become(coming, CAU_COMING_WHOLE, CAU_COMING_NOTHING);
	case CAU_COMING_FORGET:
		return coming->state == CAU_COMING_INCOMING || coming->state == CAU_COMING_WHOLE
		           ? become(coming, CAU_COMING_NOT, CAU_COMING_DO_FORGET)
		           : CAU_COMING_REFUSE;
	}
	CAU_ASSERT(false, "event %d is none", (int)event);
	return CAU_COMING_REFUSE;
}

bool cau_coming_serves(const cau_coming *coming)
{
	return coming->state == CAU_COMING_HERE;
}

cau_coming cau_coming_after_restart(bool known, bool whole, bool accepted)
{
	if (!known)
		return (cau_coming){.state = CAU_COMING_NOT};
	return (cau_coming){.state = accepted ? CAU_COMING_HERE
	                             : whole  ? CAU_COMING_WHOLE
	                                      : CAU_COMING_INCOMING};
}
