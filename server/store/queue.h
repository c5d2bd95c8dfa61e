// SPDX-License-Identifier: GPL-3.0-or-later
// The bounded queue between submitters and the store's thread.
#pragma once

#include "store_state.h"

enum cau_store_turn {
	TURN_GROUP, // queue.committing holds a group
	TURN_CHORE, // nothing to commit; a chore or an attempt while full is due
	TURN_END,   // closing, and the queue is empty
};

// Waits for something to do. A batch waits for company until commit_delay_ms after it was
// submitted.
enum cau_store_turn cau_store_queue_await(struct cau_store *store);

// Changes the state. Unless READY, moves every waiting batch behind queue.committing.
void cau_store_queue_set_state(struct cau_store *store, cau_store_state state, const char *reason);

// Calls back for every batch in queue.committing, in order, and frees it.
void cau_store_queue_answer(struct cau_store_queue *queue);
