// SPDX-License-Identifier: GPL-3.0-or-later
// The list of sessions that arrive from another daemon. arrival_pieces.c receives their pieces, and
// arrival_end.c ends the arrivals.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "move/internal.h"

typedef cau_arrival arrival;

arrival *cau_arrival_find(cau_moves *moves, const char *id)
{
	arrival *a = moves->arrivals;
	while (a && (a->forgotten || strcmp(a->id, id) != 0))
		a = a->next;
	return a;
}

arrival *cau_arrival_find_own(cau_moves *moves, const cau_move_asked *asked)
{
	arrival *a = moves->arrivals;
	while (a && (a->forgotten || strcmp(a->id, asked->session) != 0 ||
	             strcmp(a->move, asked->move) != 0))
		a = a->next;
	return a;
}

cau_status cau_arrivals_check_open(const cau_moves *moves, int32_t *code, cau_error *error)
{
	if (!moves->ends)
		return CAU_OK;
	*code = CAU_RPC_DRAINING;
	return cau_fail(error, CAU_BAD_STATE, "", "the server is shutting down");
}

bool cau_arrival_waits(const arrival *a)
{
	return a->accepting || !cau_coming_serves(&a->coming);
}

bool cau_arrivals_have(cau_moves *moves, const char *id)
{
	pthread_mutex_lock(&moves->mutex);
	const arrival *a = cau_arrival_find(moves, id);
	bool waits = a && cau_arrival_waits(a);
	pthread_mutex_unlock(&moves->mutex);
	return waits;
}

void cau_arrival_take_out(cau_moves *moves, arrival *a)
{
	CAU_ASSERT(!a->writing && !a->accepting && !a->hosted, "the arrival of %s has an owner", a->id);
	arrival **link = &moves->arrivals;
	while (*link != a)
		link = &(*link)->next;
	*link = a->next;
	free(a);
}

cau_store_arrival cau_arrival_row(const arrival *a, int64_t pieces, cau_store_arrival_state state)
{
	return (cau_store_arrival){.id = a->id,
	                           .move = a->move,
	                           .lock = a->lock,
	                           .unlock = a->unlock,
	                           .seal = a->seal,
	                           .source = a->source,
	                           .label = a->label,
	                           .pieces = pieces,
	                           .state = state};
}

static cau_status take_arrival(void *user, const cau_store_arrival *row)
{
	cau_moves *moves = user;
	arrival *a = calloc(1, sizeof *a);
	if (!a)
		return CAU_NO_MEMORY;
	snprintf(a->id, sizeof a->id, "%.48s", row->id);
	snprintf(a->move, sizeof a->move, "%.48s", row->move);
	snprintf(a->source, sizeof a->source, "%.48s", row->source);
	snprintf(a->label, sizeof a->label, "%.48s", row->label);
	snprintf(a->lock, sizeof a->lock, "%s", row->lock);
	snprintf(a->unlock, sizeof a->unlock, "%s", row->unlock);
	snprintf(a->seal, sizeof a->seal, "%s", row->seal);
	a->pieces = row->pieces;
	a->speed = 1;
	a->coming = cau_coming_after_restart(true, row->state != CAU_STORE_ARRIVING,
	                                     row->state == CAU_STORE_ACCEPTED);
	a->next = moves->arrivals;
	moves->arrivals = a;
	if (!cau_coming_serves(&a->coming))
		cau_log(CAU_LOG_WARNING, a->id, "in_doubt",
		        "move=%s from=%s whole=%d remedy=\"`cautery move %s %s` asks the source daemon\"",
		        a->move, a->source, row->state == CAU_STORE_WHOLE, a->source,
		        moves->def.config->label);
	return CAU_OK;
}

cau_status cau_arrivals_read(cau_moves *moves, cau_error *error)
{
	return cau_store_read_arrivals(moves->def.store, take_arrival, moves, error);
}

void cau_arrivals_list(const cau_moves *moves, cau_wire_list *list)
{
	cau_wire_move_entry *entries = list->items;
	for (const arrival *a = moves->arrivals; a && list->count < list->capacity; a = a->next) {
		if (a->forgotten || !cau_arrival_waits(a))
			continue;
		cau_wire_move_entry *entry = &entries[list->count++];
		cau_coming_state state = a->coming.state;
		*entry = (cau_wire_move_entry){0};
		memcpy(entry->session, a->id, sizeof entry->session);
		memcpy(entry->move, a->move, sizeof entry->move);
		memcpy(entry->other, a->source, sizeof entry->other);
		snprintf(entry->state, sizeof entry->state, "%s",
		         a->accepting                ? "accepting"
		         : state == CAU_COMING_WHOLE ? "doubt"
		                                     : "incoming");
	}
}

// Removes a core that has ended from its arrival, and returns it with a reference. Returns NULL if
// there is none.
static cau_hosted *take_ended(cau_moves *moves, bool all)
{
	cau_hosted *ended = NULL;
	pthread_mutex_lock(&moves->mutex);
	for (arrival *a = moves->arrivals, *next; a && !ended; a = next) {
		next = a->next;
		if (a->hosted && all && a->ready && !cau_hosted_ended(a->hosted))
			cau_hosted_give_up(a->hosted); // ends at once, because the builder has stopped
		if (a->hosted && cau_hosted_ended(a->hosted)) {
			ended = a->hosted;
			a->hosted = NULL;
			a->ready = false;
		}
		if (!a->hosted && a->forgotten)
			cau_arrival_take_out(moves, a);
	}
	pthread_mutex_unlock(&moves->mutex);
	return ended;
}

void cau_arrivals_reap(cau_moves *moves, bool all)
{
	for (cau_hosted *ended; (ended = take_ended(moves, all));) {
		cau_hosted_stop(ended);
		cau_hosted_release(ended);
	}
}

void cau_arrivals_free(cau_moves *moves)
{
	for (arrival *a = moves->arrivals, *next; a; a = next) {
		next = a->next;
		free(a);
	}
	moves->arrivals = NULL;
}
