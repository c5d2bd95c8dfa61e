// SPDX-License-Identifier: GPL-3.0-or-later
// Requests about sessions that move: each is a short job of the mover, since most read the store.
// What is decided is server/session/handover.h's.
#include <stdlib.h>
#include <string.h>

#include "hub/internal.h"

#define EXPECTED_S 0.05 // for the builder's order: a piece is read or written

static void list_gone(cau_hub *hub, cau_wire_list *list)
{
	cau_wire_move_entry *entries = list->items;
	for (int32_t i = 0; i < hub->tombstone_count && list->count < list->capacity; i++) {
		const cau_tombstone *from = &hub->tombstones[i];
		cau_wire_move_entry *entry = &entries[list->count++];
		*entry = (cau_wire_move_entry){.state = "gone", .has_url = *from->to.url};
		memcpy(entry->session, from->id, sizeof entry->session);
		memcpy(entry->move, from->move, sizeof entry->move);
		memcpy(entry->other, from->to.session, sizeof entry->other);
		snprintf(entry->url, sizeof entry->url, "%s", from->to.url);
	}
}

static void list_moves(cau_move_job *job)
{
	enum { MOST = 1024 };
	cau_hub *hub = job->hub;
	cau_wire_move_list result = {.moves = {calloc(MOST, sizeof(cau_wire_move_entry)), 0, MOST}};
	if (!result.moves.items) {
		cau_move_fail(&job->reply, CAU_NO_MEMORY, 0, "", "no memory for the list");
		return;
	}
	pthread_mutex_lock(&hub->moves_mutex);
	cau_departures_list(hub, &result.moves);
	cau_arrivals_list(hub, &result.moves);
	list_gone(hub, &result.moves);
	pthread_mutex_unlock(&hub->moves_mutex);
	cau_move_answer(&job->reply, &result);
	free(result.moves.items);
}

static void (*const serves[])(cau_move_job *job) = {
	[CAU_MOVE_BEGIN] = cau_departure_begin,   [CAU_MOVE_READ] = cau_departure_read,
	[CAU_MOVE_HOLD] = cau_departure_hold,     [CAU_MOVE_COMMIT] = cau_departure_commit,
	[CAU_MOVE_CANCEL] = cau_departure_cancel, [CAU_MOVE_RECEIVE] = cau_arrival_receive,
	[CAU_MOVE_READY] = cau_arrival_ready,     [CAU_MOVE_ACCEPT] = cau_arrival_accept,
	[CAU_MOVE_FORGET] = cau_arrival_forget,   [CAU_MOVE_LIST] = list_moves};

static void finish(cau_move_job *what)
{
	free(what->asked.piece);
	free(what);
}

static void drop(cau_job *job)
{
	cau_move_job *what = (cau_move_job *)job;
	cau_move_fail(&what->reply, CAU_BAD_STATE, CAU_RPC_DRAINING, "", "the server is shutting down");
	finish(what);
}

static void run(cau_job *job)
{
	cau_move_job *what = (cau_move_job *)job;
	pthread_mutex_lock(&what->hub->moves_mutex);
	bool ends = what->hub->moves_end;
	pthread_mutex_unlock(&what->hub->moves_mutex);
	if (ends) {
		drop(job);
		return;
	}
	serves[what->asked.what](what);
	finish(what);
}

cau_status cau_hub_move(cau_hub *hub, const cau_move_asked *asked, const cau_reply *reply,
                        cau_error *error)
{
	cau_move_job *what = malloc(sizeof *what);
	if (!what) {
		free(asked->piece);
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the request");
	}
	*what = (cau_move_job){.job = {.run = run, .drop = drop, .expected_s = EXPECTED_S},
	                       .hub = hub,
	                       .asked = *asked,
	                       .reply = *reply};
	cau_builder_submit(hub->around.mover, &what->job);
	return CAU_OK;
}
