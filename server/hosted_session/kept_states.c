// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/kept_states.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

static void drop(cau_kept_states *kept, int32_t index)
{
	CAU_ASSERT(index >= 0 && index < kept->count, "state %d of %d", index, kept->count);
	cau_kept_state *state = &kept->state[index];
	kept->byte_count -= state->byte_count;
	free(state->bytes);
	kept->count--;
	memmove(state, state + 1, (size_t)(kept->count - index) * sizeof *state);
	kept->state[kept->count] = (cau_kept_state){0};
}

// Longest replay, in ticks, to a tick near this state if the state were dropped. The first and the
// last state have only one neighbour, so the distance to this neighbour is doubled. Ticks before
// the first state are reached from the store.
static uint64_t gap_without(const cau_kept_states *kept, int32_t index)
{
	uint64_t tick = kept->state[index].tick;
	uint64_t before = index ? kept->state[index - 1].tick : tick;
	uint64_t after = index + 1 < kept->count ? kept->state[index + 1].tick : tick;
	return index && index + 1 < kept->count ? after - before : 2 * (after - before);
}

static int32_t least_missed(const cau_kept_states *kept)
{
	int32_t least = 0;
	for (int32_t i = 1; i < kept->count; i++)
		if (gap_without(kept, i) < gap_without(kept, least))
			least = i;
	return least;
}

// Returns the index where a state of this tick is, or would be inserted.
static int32_t place_of(const cau_kept_states *kept, uint64_t tick)
{
	int32_t place = 0;
	while (place < kept->count && kept->state[place].tick < tick)
		place++;
	return place;
}

void cau_kept_states_put(cau_kept_states *kept, size_t budget, int64_t branch,
                         const cau_kept_state *state)
{
	if (branch != kept->branch)
		cau_kept_states_finish(kept);
	kept->branch = branch;
	int32_t place = place_of(kept, state->tick);
	if (place < kept->count && kept->state[place].tick == state->tick)
		drop(kept, place);
	else if (kept->count == CAU_KEPT_STATES_MOST)
		drop(kept, least_missed(kept));
	place = place_of(kept, state->tick);
	memmove(&kept->state[place + 1], &kept->state[place],
	        (size_t)(kept->count - place) * sizeof *state);
	kept->state[place] = *state;
	kept->count++;
	kept->byte_count += state->byte_count;
	while (kept->count > 0 && kept->byte_count > budget)
		drop(kept, least_missed(kept));
}

const cau_kept_state *cau_kept_states_find(const cau_kept_states *kept, int64_t branch,
                                           uint64_t tick)
{
	int32_t after = place_of(kept, tick + 1);
	return branch == kept->branch && after ? &kept->state[after - 1] : NULL;
}

void cau_kept_states_finish(cau_kept_states *kept)
{
	while (kept->count)
		drop(kept, kept->count - 1);
}
