// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that another daemon has now, by their old ids. In memory, since the network thread asks
// for them and touches no disk.
#include <stdlib.h>
#include <string.h>

#include "hub/internal.h"

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

static bool make_room(cau_hub *hub)
{
	if (hub->tombstone_count < hub->tombstone_capacity)
		return true;
	int32_t capacity = hub->tombstone_capacity ? 2 * hub->tombstone_capacity : 16;
	cau_tombstone *grown = realloc(hub->tombstones, (size_t)capacity * sizeof *grown);
	if (!grown)
		return false;
	hub->tombstones = grown;
	hub->tombstone_capacity = capacity;
	return true;
}

bool cau_tombstone_put(cau_hub *hub, const cau_tombstone *made)
{
	int32_t place = place_of(hub, made->id);
	if (!is_at(hub, place, made->id)) {
		if (!make_room(hub))
			return false;
		memmove(&hub->tombstones[place + 1], &hub->tombstones[place],
		        (size_t)(hub->tombstone_count - place) * sizeof *made);
		hub->tombstone_count++;
	}
	hub->tombstones[place] = *made;
	return true;
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
	return cau_tombstone_put(user, &made) ? CAU_OK : CAU_NO_MEMORY;
}

cau_status cau_tombstones_read(cau_hub *hub, cau_error *error)
{
	return cau_store_read_moved(hub->def.store, take, hub, error);
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
