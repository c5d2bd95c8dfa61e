// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the frame that a subscriber gets next, on the thread of its transport.
#include <string.h>

#include "stream/internal.h"

#define KEY_PAUSE_S 1.0 // time between two key frames of one client

static cau_buffer *take_frame(cau_subscriber *sub, const cau_stream *stream,
                              const cau_ring_frame *frame)
{
	if (sub->epoch != stream->epoch)
		memset(sub->sent, 0, sizeof sub->sent); // each epoch numbers its frames from the start
	sub->has_key = true;
	sub->wants_key = false;
	sub->epoch = stream->epoch;
	sub->sequence = frame->sequence;
	sub->sent[frame->sequence % SENT_FRAMES].sequence = frame->sequence;
	sub->sent[frame->sequence % SENT_FRAMES].bytes = frame->buffer->byte_count;
	sub->in_flight += frame->buffer->byte_count;
	return cau_buffer_share(frame->buffer);
}

// Returns the key frame if all deltas after it are still in the ring. Otherwise requests a new one
// and returns NULL.
static cau_buffer *next_key(cau_stream *stream, cau_subscriber *sub, double now_s, bool *wake)
{
	bool whole = stream->key.buffer && stream->newest < stream->key.sequence + RING_FRAMES;
	bool newer =
		!sub->has_key || sub->epoch != stream->epoch || stream->key.sequence > sub->sequence;
	if (whole && newer)
		return take_frame(sub, stream, &stream->key);
	if (now_s - sub->key_asked_s >= KEY_PAUSE_S) {
		sub->key_asked_s = now_s;
		stream->key_wanted = *wake = true;
	}
	return NULL;
}

static cau_buffer *next_delta(const cau_streams *streams, cau_stream *stream, cau_subscriber *sub,
                              double now_s, size_t bound)
{
	if (sub->sequence >= stream->newest)
		return NULL;
	const cau_ring_frame *frame = cau_half_choose(stream, sub, now_s);
	if (!frame)
		return NULL;
	uint64_t over = frame->sequence - sub->sequence;
	if (!frame->buffer || over == 0 || over > CAU_FRAME_THINNING) { // the frame has left the ring
		sub->wants_key = true;
		cau_half_fallen(streams, stream, sub);
		return NULL;
	}
	if (sub->acknowledges && sub->in_flight > bound)
		return NULL;
	cau_half_steady(streams, stream, sub);
	return take_frame(sub, stream, frame);
}

cau_buffer *cau_streams_next_frame(cau_streams *streams, cau_subscriber *sub, double now_s,
                                   bool *wake)
{
	cau_buffer *buffer = NULL;
	cau_stream *stream = &streams->stream[sub->stream];
	size_t bound = streams->in_flight_most;
	*wake = false;
	pthread_mutex_lock(&streams->mutex);
	if (!sub->topology_sent) {
		sub->topology_sent = sub->wants_key = true;
		buffer = cau_buffer_share(stream->topology);
	} else {
		if (sub->epoch != stream->epoch)
			sub->wants_key = true;
		if (!sub->wants_key)
			buffer = next_delta(streams, stream, sub, now_s, bound);
		if (sub->wants_key && !(sub->acknowledges && sub->in_flight > bound))
			buffer = next_key(stream, sub, now_s, wake);
	}
	pthread_mutex_unlock(&streams->mutex);
	return buffer;
}

bool cau_streams_has_frame(cau_streams *streams, const cau_subscriber *sub)
{
	const cau_stream *stream = &streams->stream[sub->stream];
	pthread_mutex_lock(&streams->mutex);
	bool behind = !sub->topology_sent || sub->epoch != stream->epoch || sub->wants_key ||
	              sub->sequence < stream->newest;
	pthread_mutex_unlock(&streams->mutex);
	return behind;
}

// Returns the oldest of the last SENT_FRAMES frames, whose sizes are known.
static uint64_t oldest_known(const cau_subscriber *sub)
{
	uint64_t oldest = UINT64_MAX;
	for (size_t i = 0; i < SENT_FRAMES; i++)
		if (sub->sent[i].sequence && sub->sent[i].sequence < oldest)
			oldest = sub->sent[i].sequence;
	return oldest;
}

void cau_streams_acknowledge(cau_subscriber *sub, uint64_t epoch, uint64_t sequence)
{
	if (epoch != sub->epoch || sequence > sub->sequence)
		return;
	sub->acknowledges = true;
	if (sequence < oldest_known(sub))
		// Frames between the two sequences may be on their way, and their sizes are forgotten.
		return;
	sub->in_flight = 0;
	for (size_t i = 0; i < SENT_FRAMES; i++)
		if (sub->sent[i].sequence <= sequence)
			// The client has this frame, whatever sequence it acknowledges later.
			sub->sent[i].bytes = 0;
		else
			sub->in_flight += sub->sent[i].bytes;
}

void cau_streams_leave(cau_streams *streams, const cau_subscriber *sub)
{
	pthread_mutex_lock(&streams->mutex);
	streams->stream[sub->stream].subscribers--;
	cau_half_leave(&streams->stream[sub->stream], sub);
	pthread_mutex_unlock(&streams->mutex);
}

void cau_streams_count(cau_streams *streams, cau_stream_counts *counts)
{
	pthread_mutex_lock(&streams->mutex);
	*counts = streams->counts;
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++) {
		counts->subscribers += streams->stream[i].subscribers;
		counts->half_rate += streams->stream[i].half.subscribers;
	}
	pthread_mutex_unlock(&streams->mutex);
}
