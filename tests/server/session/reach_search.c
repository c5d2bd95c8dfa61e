// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/reach_search.h"

#include <stdlib.h>

enum { FIRST = 1 << 12 };

static void *grow(void *old, size_t count, size_t bytes)
{
	void *grown = realloc(old, count * bytes);
	if (!grown)
		abort();
	return grown;
}

// Mixes the words so that the low bits are as random as the others.
static uint32_t hash_of(const reach_packed *state)
{
	uint64_t hash = state->word[0] * 0x9e3779b97f4a7c15u;
	hash = (hash ^ hash >> 29 ^ state->word[1]) * 0xbf58476d1ce4e5b9u;
	hash = (hash ^ hash >> 32) * 0x94d049bb133111ebu;
	return (uint32_t)(hash ^ hash >> 32);
}

static bool is_same(const reach_packed *a, const reach_packed *b)
{
	return a->word[0] == b->word[0] && a->word[1] == b->word[1];
}

static void put(reach_found *f, uint32_t number)
{
	uint32_t slot = hash_of(&f->states[number]) & (f->slot_count - 1);
	while (f->slots[slot])
		slot = (slot + 1) & (f->slot_count - 1);
	f->slots[slot] = number + 1;
}

static void make_room(reach_found *f)
{
	f->capacity = 2 * f->capacity < f->most ? 2 * f->capacity : f->most;
	f->slot_count *= 2;
	f->states = grow(f->states, f->capacity, sizeof *f->states);
	f->parents = grow(f->parents, f->capacity, sizeof *f->parents);
	f->by = grow(f->by, f->capacity, 1);
	free(f->slots);
	f->slots = calloc(f->slot_count, sizeof *f->slots);
	if (!f->slots)
		abort();
	for (uint32_t i = 0; i < f->count; i++)
		put(f, i);
}

void reach_found_init(reach_found *f, uint32_t most)
{
	*f = (reach_found){.most = most, .capacity = FIRST / 2, .slot_count = FIRST};
	make_room(f);
}

void reach_found_finish(reach_found *f)
{
	free(f->states);
	free(f->parents);
	free(f->by);
	free(f->slots);
}

bool reach_found_add(reach_found *f, const reach_packed *state, uint32_t parent, int by)
{
	uint32_t slot = hash_of(state) & (f->slot_count - 1);
	for (; f->slots[slot]; slot = (slot + 1) & (f->slot_count - 1))
		if (is_same(&f->states[f->slots[slot] - 1], state))
			return true;
	if (f->count == f->most)
		return false;
	if (f->count == f->capacity)
		make_room(f);
	f->states[f->count] = *state;
	f->parents[f->count] = parent;
	f->by[f->count] = (uint8_t)by;
	put(f, f->count++);
	return true;
}
