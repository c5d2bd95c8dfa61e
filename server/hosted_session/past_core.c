// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/past_views.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hosted_session/life.h"
#include "hosted_session/published.h"

// ---- kept states --------------------------------------------------------------------------------

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

// ---- the second core ----------------------------------------------------------------------------

// Fewest ticks between two kept states. In most scenes this is half a second, which is replayed
// faster than a user notices.
enum { KEPT_TICKS = 30 };

// ---- building -----------------------------------------------------------------------------------
typedef struct border {
	cau_past_core *past;
	cau_past_core_border *go_on;
	void *user;
} border;

static cau_status cross_border(void *user, const cau_build_border *at, cau_error *error)
{
	const border *b = user;
	cau_past_core *past = b->past;
	cau_status status = b->go_on(b->user, error);
	return status ? status
	              : cau_building_hold(past->identity->around, &past->memory_held,
	                                  (int64_t)at->bytes, "a past view", error);
}

cau_status cau_past_core_build(cau_past_core *past, cau_past_core_border *go_on, void *user,
                               cau_error *error)
{
	border at = {past, go_on, user};
	cau_session_def def = cau_default_session_def();
	def.scene = past->identity->scene;
	def.thread_count = (int32_t)past->identity->around->config->session_threads;
	def.border = cross_border;
	def.user = &at;
	def.unsettled = true; // the core will be restored to a past state
	cau_status status = cau_session_create(&def, &past->session, error);
	if (status)
		cau_past_core_finish(past);
	return status;
}

// ---- reaching a tick ----------------------------------------------------------------------------

// Replaces the checkpoint's snapshot by that of a kept state.
static cau_status begin_at_kept(cau_past_core *past, const cau_kept_state *kept, cau_error *error)
{
	cau_replay *replay = &past->replay;
	void *copy = malloc(kept->byte_count);
	if (!copy)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a past view");
	memcpy(copy, kept->bytes, kept->byte_count);
	free(replay->snapshot);
	replay->snapshot = copy;
	replay->snapshot_bytes = kept->byte_count;
	cau_replay_shorten(replay, kept->tick);
	return CAU_OK;
}

cau_status cau_past_core_read(cau_past_core *past, int64_t branch, uint64_t tick, cau_error *error)
{
	cau_replay *replay = &past->replay;
	uint64_t at = replay->tick;
	cau_status status = cau_replay_check(past->identity, past->commits, branch, true, tick, error);
	if (!status)
		status = cau_replay_read(replay, past->identity->around->store, past->identity->id, branch,
		                         tick, error);
	if (status)
		return status;
	const cau_kept_state *kept = cau_kept_states_find(&past->kept, branch, tick);
	uint64_t nearest = kept && kept->tick > replay->from ? kept->tick : replay->from;
	past->arrived = past->somewhere && past->branch == branch && at >= nearest && at <= tick;
	past->branch = branch;
	if (past->arrived)
		cau_replay_shorten(replay, at);
	else if (kept && kept->tick > replay->from)
		return begin_at_kept(past, kept, error);
	return CAU_OK;
}

cau_status cau_past_core_restore(cau_past_core *past, cau_error *error)
{
	if (past->arrived)
		return CAU_OK;
	const cau_kept_state *kept = cau_kept_states_find(&past->kept, past->branch, past->replay.from);
	bool was_exact = !kept || kept->tick != past->replay.from || kept->exact;
	past->somewhere = false;
	cau_status status = cau_replay_restore(&past->replay, past->session, error);
	past->replay.exact &= was_exact;
	past->somewhere = !status;
	return status;
}

// Keeps the core's state for later views. Nothing depends on it, so nothing is kept if memory runs
// out.
static void keep(cau_past_core *past)
{
	size_t budget = (size_t)past->identity->around->config->look_bytes;
	size_t capacity = cau_session_snapshot_bytes(past->session);
	uint64_t tick = past->replay.tick;
	const cau_kept_state *before = cau_kept_states_find(&past->kept, past->branch, tick);
	if (capacity > budget || (before && tick - before->tick < KEPT_TICKS))
		return;
	cau_kept_state state = {.tick = tick, .exact = past->replay.exact, .bytes = malloc(capacity)};
	if (state.bytes &&
	    !cau_session_snapshot(past->session, state.bytes, capacity, &state.byte_count, NULL)) {
		void *fitting = realloc(state.bytes, state.byte_count);
		state.bytes = fitting ? fitting : state.bytes;
		cau_kept_states_put(&past->kept, budget, past->branch, &state);
	} else {
		free(state.bytes);
	}
}

cau_status cau_past_core_slice(cau_past_core *past, double seconds, bool *over, cau_error *error)
{
	CAU_ASSERT(past->somewhere, "the past view of session %s has no start", past->identity->id);
	cau_status status = cau_replay_slice(&past->replay, past->session, seconds, over, error);
	past->somewhere = !status;
	if (!status)
		keep(past);
	return status;
}

// ---- the frame ----------------------------------------------------------------------------------
static cau_status encode(const cau_stream_sample *sample, const cau_stream_def *def, uint64_t epoch,
                         void *storage, void *scratch, size_t *bytes, cau_error *error)
{
	cau_frame_encoder *encoder;
	cau_status status =
		cau_frame_encoder_init(storage, cau_frame_encoder_bytes(def), def, epoch, &encoder, error);
	if (!status) // the first frame of an epoch is a key frame
		status = cau_frame_encode(encoder, sample, scratch, cau_frame_bytes_max(def), bytes, error);
	return status;
}

cau_buffer *cau_past_core_frame(cau_past_core *past, const cau_stream_def *def, uint64_t epoch,
                                cau_error *error)
{
	cau_shown shown;
	size_t bytes = 0;
	cau_buffer *frame = NULL;
	void *storage = malloc(cau_frame_encoder_bytes(def));
	void *scratch = malloc(cau_frame_bytes_max(def));
	cau_session_watch(past->session, def->channels);
	cau_show(past->session, &shown);
	shown.sample.flags = CAU_FRAME_PAUSED;
	cau_status status = storage && scratch
	                        ? encode(&shown.sample, def, epoch, storage, scratch, &bytes, error)
	                        : CAU_NO_MEMORY;
	if (!status)
		frame = cau_buffer_create(bytes, true);
	if (frame)
		memcpy(cau_buffer_bytes(frame), scratch, bytes);
	else if (!status || status == CAU_NO_MEMORY)
		cau_fail(error, CAU_NO_MEMORY, "", "no memory for a frame of the past");
	free(scratch);
	free(storage);
	return frame;
}

void cau_past_core_finish(cau_past_core *past)
{
	cau_session_destroy(past->session);
	past->session = NULL;
	past->somewhere = past->arrived = false;
	cau_replay_finish(&past->replay);
	cau_kept_states_finish(&past->kept);
	cau_building_release(past->identity->around, &past->memory_held);
}
