// SPDX-License-Identifier: GPL-3.0-or-later
// The bounded queue between submitters and the store thread.
#pragma once

#include "store_state.h"

enum cau_store_turn {
	TURN_GROUP, // queue.committing holds a group
	TURN_CHORE, // nothing to commit; a chore or an attempt while full is due
	TURN_END,   // the store is closing, and the queue is empty
};

// Waits until the store thread has something to do. A batch waits for others until commit_delay_ms
// after its submission.
enum cau_store_turn cau_store_queue_await(struct cau_store *store);

// Changes the state. Unless the new state is READY, appends every waiting batch to
// queue.committing.
void cau_store_queue_set_state(struct cau_store *store, cau_store_state state, const char *reason);

// Calls the callback of each batch in queue.committing, in order, and frees the batches.
void cau_store_queue_answer(struct cau_store_queue *queue);
