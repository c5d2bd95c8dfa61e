// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that have moved to another daemon, by their old ids. They are kept in memory, because
// the network thread searches them and must not touch a disk.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "move/internal.h"

// Returns the index of the first tombstone whose id is not less than this one.
static int32_t place_of(const cau_moves *moves, const char *id)
{
	int32_t low = 0, high = moves->tombstone_count;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		if (strcmp(moves->tombstones[middle].id, id) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static bool is_at(const cau_moves *moves, int32_t place, const char *id)
{
	return place < moves->tombstone_count && strcmp(moves->tombstones[place].id, id) == 0;
}

const cau_tombstone *cau_tombstone_find(const cau_moves *moves, const char *id)
{
	int32_t place = place_of(moves, id);
	return is_at(moves, place, id) ? &moves->tombstones[place] : NULL;
}

static bool make_room(cau_moves *moves, int32_t count)
{
	if (moves->tombstone_count + count <= moves->tombstone_capacity)
		return true;
	int32_t capacity = 2 * moves->tombstone_capacity + count + 15;
	cau_tombstone *grown = realloc(moves->tombstones, (size_t)capacity * sizeof *grown);
	if (!grown)
		return false;
	moves->tombstones = grown;
	moves->tombstone_capacity = capacity;
	return true;
}

bool cau_tombstones_reserve(cau_moves *moves)
{
	int32_t count = 0;
	for (const cau_departure *d = moves->departures; d; d = d->next)
		count++;
	return make_room(moves, count);
}

void cau_tombstone_put(cau_moves *moves, const cau_tombstone *made)
{
	int32_t place = place_of(moves, made->id);
	if (!is_at(moves, place, made->id)) {
		CAU_ASSERT(moves->tombstone_count < moves->tombstone_capacity, "no capacity for %s",
		           made->id);
		memmove(&moves->tombstones[place + 1], &moves->tombstones[place],
		        (size_t)(moves->tombstone_count - place) * sizeof *made);
		moves->tombstone_count++;
	}
	moves->tombstones[place] = *made;
}

void cau_tombstone_drop(cau_moves *moves, const char *id)
{
	int32_t place = place_of(moves, id);
	if (!is_at(moves, place, id))
		return;
	moves->tombstone_count--;
	memmove(&moves->tombstones[place], &moves->tombstones[place + 1],
	        (size_t)(moves->tombstone_count - place) * sizeof *moves->tombstones);
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

cau_status cau_tombstones_read(cau_moves *moves, cau_error *error)
{
	cau_status status = cau_store_move_secret(moves->def.store, moves->secret, error);
	return status ? status : cau_store_read_moved(moves->def.store, take, moves, error);
}

bool cau_tombstones_have(cau_moves *moves, const char *id, cau_moved_to *to)
{
	pthread_mutex_lock(&moves->mutex);
	const cau_tombstone *found = cau_tombstone_find(moves, id);
	if (found)
		*to = found->to;
	pthread_mutex_unlock(&moves->mutex);
	return found != NULL;
}

void cau_tombstones_list(const cau_moves *moves, cau_wire_list *list)
{
	cau_wire_move_entry *entries = list->items;
	for (int32_t i = 0; i < moves->tombstone_count && list->count < list->capacity; i++) {
		const cau_tombstone *from = &moves->tombstones[i];
		cau_wire_move_entry *entry = &entries[list->count++];
		*entry = (cau_wire_move_entry){.state = "gone", .has_url = *from->to.url};
		memcpy(entry->session, from->id, sizeof entry->session);
		memcpy(entry->move, from->move, sizeof entry->move);
		memcpy(entry->other, from->to.session, sizeof entry->other);
		snprintf(entry->url, sizeof entry->url, "%s", from->to.url);
	}
}
