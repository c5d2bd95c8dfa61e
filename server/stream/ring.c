// SPDX-License-Identifier: GPL-3.0-or-later
// The newest frames of a stream, each in a counted buffer that all its subscribers share. They
// include the deltas over two frames for slow subscribers.
#include <stdlib.h>
#include <string.h>

#include "stream/internal.h"

// ---- the ring
cau_buffer *cau_ring_take(const cau_stream *stream, size_t bytes)
{
	cau_buffer *buffer = cau_buffer_create(bytes, true);
	if (buffer)
		memcpy(cau_buffer_bytes(buffer), stream->scratch, bytes);
	return buffer;
}

void cau_ring_put_delta(cau_streams *streams, cau_stream *stream, cau_buffer *buffer,
                        uint64_t sequence)
{
	pthread_mutex_lock(&streams->mutex);
	cau_ring_frame *slot = &stream->ring[sequence % RING_FRAMES];
	cau_buffer_release(slot->buffer);
	*slot = (cau_ring_frame){sequence, buffer};
	stream->newest = sequence;
	stream->newest_s = cau_monotonic_s();
	streams->counts.frames++;
	streams->counts.frame_bytes += buffer->byte_count;
	pthread_mutex_unlock(&streams->mutex);
}

void cau_ring_put_key(cau_streams *streams, cau_stream *stream, cau_buffer *buffer,
                      uint64_t sequence)
{
	pthread_mutex_lock(&streams->mutex);
	cau_buffer_release(stream->key.buffer);
	stream->key = (cau_ring_frame){sequence, buffer};
	stream->newest = sequence;
	stream->newest_s = cau_monotonic_s();
	stream->key_wanted = false;
	streams->counts.key_frames++;
	pthread_mutex_unlock(&streams->mutex);
}

static void clear(cau_ring_frame *frames, int count)
{
	for (int i = 0; i < count; i++) {
		cau_buffer_release(frames[i].buffer);
		frames[i] = (cau_ring_frame){0};
	}
}

void cau_ring_clear(cau_stream *stream)
{
	clear(stream->ring, RING_FRAMES);
	clear(stream->half.ring, RING_FRAMES);
	clear(&stream->key, 1);
	stream->newest = 0;
}

// ---- half rate
// A subscriber that keeps falling behind gets every second frame. All such subscribers of a profile
// share one delta over two frames. This delta belongs to the same chain, so a subscriber changes
// between the two rates without a key frame.

enum {
	FALLS_TOLERATED = 3,
	STEADY_FRAMES = 600, // number of frames without a fall after which earlier falls are forgotten
};
// time after which the last frame is sent singly, because no other frame may follow
#define ALONE_S 0.25

static size_t slot_of(uint64_t sequence)
{
	return sequence / CAU_FRAME_THINNING % RING_FRAMES;
}

static bool is_wanted(cau_streams *streams, const cau_stream *stream)
{
	pthread_mutex_lock(&streams->mutex);
	bool wanted = stream->half.subscribers > 0;
	pthread_mutex_unlock(&streams->mutex);
	return wanted;
}

static cau_status open_lane(cau_stream *stream, cau_error *error)
{
	cau_half_lane *lane = &stream->half;
	size_t bytes = cau_frame_thinner_bytes(&stream->def);
	lane->storage = malloc(bytes);
	if (!lane->storage)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a stream at half rate");
	return cau_frame_thinner_init(lane->storage, bytes, stream->encoder, &lane->thinner, error);
}

void cau_half_publish(cau_streams *streams, cau_stream *stream)
{
	cau_error error = {0};
	size_t bytes = 0;
	if (!is_wanted(streams, stream))
		return;
	cau_status status = stream->half.storage ? CAU_OK : open_lane(stream, &error);
	if (!status)
		status = cau_frame_thin(stream->half.thinner, stream->scratch, stream->scratch_bytes,
		                        &bytes, &error);
	// Without the delta over two frames, these subscribers continue with single frames.
	if (status)
		cau_log(CAU_LOG_ERROR, streams->id, "half_rate_failed", "reason=\"%s\"", error.reason);
	cau_buffer *buffer = bytes ? cau_ring_take(stream, bytes) : NULL;
	if (!buffer)
		return;
	uint64_t sequence = cau_frame_encoder_sequence(stream->encoder);
	pthread_mutex_lock(&streams->mutex);
	cau_ring_frame *slot = &stream->half.ring[slot_of(sequence)];
	cau_buffer_release(slot->buffer);
	*slot = (cau_ring_frame){sequence, buffer};
	pthread_mutex_unlock(&streams->mutex);
}

const cau_ring_frame *cau_half_choose(const cau_stream *stream, const cau_subscriber *sub,
                                      double now_s)
{
	const cau_ring_frame *single = &stream->ring[(sub->sequence + 1) % RING_FRAMES];
	uint64_t next = sub->sequence + CAU_FRAME_THINNING;
	if (!sub->half || sub->sequence % CAU_FRAME_THINNING)
		return single;
	const cau_ring_frame *twice = &stream->half.ring[slot_of(next)];
	if (twice->buffer && twice->sequence == next)
		return twice;
	bool comes = stream->newest < next && now_s - stream->newest_s < ALONE_S;
	return comes ? NULL : single;
}

static void change(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub, bool half)
{
	sub->half = half;
	stream->half.subscribers += half ? 1 : -1;
	cau_log(CAU_LOG_INFO, streams->id, half ? "half_rate" : "full_rate",
	        "profile=%u subscribers=%d", stream->def.profile, stream->half.subscribers);
}

void cau_half_fallen(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub)
{
	sub->steady = 0;
	if (!sub->half && ++sub->falls > FALLS_TOLERATED)
		change(streams, stream, sub, true);
}

void cau_half_steady(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub)
{
	if (++sub->steady < STEADY_FRAMES)
		return;
	sub->steady = 0;
	sub->falls = 0;
	if (!sub->half)
		return;
	change(streams, stream, sub, false);
	sub->falls = FALLS_TOLERATED; // after one more fall, the subscriber gets half the rate again
}

void cau_half_leave(cau_stream *stream, const cau_subscriber *sub)
{
	stream->half.subscribers -= sub->half;
}
