// SPDX-License-Identifier: GPL-3.0-or-later
// A session that leaves for another daemon.
#pragma once

#include "hub/internal.h"
#include "session/handover.h"
#include "store/dump.h"

struct cau_departure {
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
};

// All three: with the moves' lock. The move that is asked about; NULL: it is not under way here.
struct cau_departure *cau_departure_find_own(cau_hub *hub, const cau_move_asked *asked);
// Out of the list; frees it, or leaves that to whoever reads its rows.
void cau_departure_take_out(cau_hub *hub, struct cau_departure *departure);
void cau_departure_fail_unknown(const cau_reply *reply);
