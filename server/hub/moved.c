// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that another daemon has now, by their old ids, and those that come from another. In
// memory, since the network thread asks for them and touches no disk.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hub/departure.h"

// The first whose id is not before this one's.
static int32_t place_of(const cau_hub *hub, const char *id)
{
	int32_t low = 0, high = hub->tombstone_count;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		if (strcmp(hub->tombstones[middle].id, id) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static bool is_at(const cau_hub *hub, int32_t place, const char *id)
{
	return place < hub->tombstone_count && strcmp(hub->tombstones[place].id, id) == 0;
}

const cau_tombstone *cau_tombstone_find(const cau_hub *hub, const char *id)
{
	int32_t place = place_of(hub, id);
	return is_at(hub, place, id) ? &hub->tombstones[place] : NULL;
}

static bool make_room(cau_hub *hub, int32_t count)
{
	if (hub->tombstone_count + count <= hub->tombstone_capacity)
		return true;
	int32_t capacity = 2 * hub->tombstone_capacity + count + 15;
	cau_tombstone *grown = realloc(hub->tombstones, (size_t)capacity * sizeof *grown);
	if (!grown)
		return false;
	hub->tombstones = grown;
	hub->tombstone_capacity = capacity;
	return true;
}

bool cau_tombstones_reserve(cau_hub *hub)
{
	int32_t count = 0;
	for (const struct cau_departure *d = hub->departures; d; d = d->next)
		count++;
	return make_room(hub, count);
}

void cau_tombstone_put(cau_hub *hub, const cau_tombstone *made)
{
	int32_t place = place_of(hub, made->id);
	if (!is_at(hub, place, made->id)) {
		CAU_ASSERT(hub->tombstone_count < hub->tombstone_capacity, "no capacity for %s", made->id);
		memmove(&hub->tombstones[place + 1], &hub->tombstones[place],
		        (size_t)(hub->tombstone_count - place) * sizeof *made);
		hub->tombstone_count++;
	}
	hub->tombstones[place] = *made;
}

void cau_tombstone_drop(cau_hub *hub, const char *id)
{
	int32_t place = place_of(hub, id);
	if (!is_at(hub, place, id))
		return;
	hub->tombstone_count--;
	memmove(&hub->tombstones[place], &hub->tombstones[place + 1],
	        (size_t)(hub->tombstone_count - place) * sizeof *hub->tombstones);
}

static cau_status take(void *user, const cau_store_moved *row)
{
	cau_tombstone made = {0};
	snprintf(made.id, sizeof made.id, "%.48s", row->id);
	snprintf(made.move, sizeof made.move, "%.48s", row->move);
	snprintf(made.to.session, sizeof made.to.session, "%.48s", row->target);
	snprintf(made.to.url, sizeof made.to.url, "%s", row->url);
	snprintf(made.proof, sizeof made.proof, "%s", row->proof);
	if (!make_room(user, 1))
		return CAU_NO_MEMORY;
	cau_tombstone_put(user, &made);
	return CAU_OK;
}

cau_status cau_tombstones_read(cau_hub *hub, cau_error *error)
{
	cau_status status = cau_store_move_secret(hub->def.store, hub->move_secret, error);
	return status ? status : cau_store_read_moved(hub->def.store, take, hub, error);
}

bool cau_hub_moved(cau_hub *hub, const char *id, cau_moved_to *to)
{
	pthread_mutex_lock(&hub->moves_mutex);
	const cau_tombstone *found = cau_tombstone_find(hub, id);
	if (found)
		*to = found->to;
	pthread_mutex_unlock(&hub->moves_mutex);
	return found != NULL;
}

// ---- on their way here --------------------------------------------------------------------------

cau_arrival *cau_arrival_find(cau_hub *hub, const char *id)
{
	cau_arrival *a = hub->arrivals;
	while (a && (a->forgotten || strcmp(a->id, id) != 0))
		a = a->next;
	return a;
}

bool cau_arrivals_have(cau_hub *hub, const char *id)
{
	pthread_mutex_lock(&hub->moves_mutex);
	const cau_arrival *a = cau_arrival_find(hub, id);
	bool waits = a && !cau_coming_serves(&a->coming);
	pthread_mutex_unlock(&hub->moves_mutex);
	return waits;
}

static cau_status take_arrival(void *user, const cau_store_arrival *row)
{
	cau_hub *hub = user;
	cau_arrival *a = calloc(1, sizeof *a);
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
	a->next = hub->arrivals;
	hub->arrivals = a;
	if (!cau_coming_serves(&a->coming))
		cau_log(CAU_LOG_WARNING, a->id, "in_doubt",
		        "move=%s from=%s whole=%d remedy=\"`cautery move %s %s` asks the daemon that it "
		        "came from\"",
		        a->move, a->source, row->state == CAU_STORE_WHOLE, a->source,
		        hub->def.config->label);
	return CAU_OK;
}

cau_status cau_arrivals_read(cau_hub *hub, cau_error *error)
{
	return cau_store_read_arrivals(hub->def.store, take_arrival, hub, error);
}
