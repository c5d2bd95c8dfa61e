// SPDX-License-Identifier: GPL-3.0-or-later
// What a subscriber gets next; on the transport's thread.
#include "hosted_session/internal.h"

#define KEY_PAUSE_S 1.0 // between key frames of one client

static cau_buffer *take_frame(cau_subscriber *sub, const cau_stream *stream,
                              const cau_ring_frame *frame)
{
	sub->has_key = true;
	sub->wants_key = false;
	sub->epoch = stream->epoch;
	sub->sequence = frame->sequence;
	sub->sent[frame->sequence % 32].sequence = frame->sequence;
	sub->sent[frame->sequence % 32].bytes = frame->buffer->byte_count;
	sub->in_flight += frame->buffer->byte_count;
	return cau_buffer_share(frame->buffer);
}

// The key frame, if the deltas after it are still there; otherwise a new one is ordered.
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

static cau_buffer *next_delta(cau_hosted *h, cau_stream *stream, cau_subscriber *sub, double now_s,
                              size_t bound)
{
	if (sub->sequence >= stream->newest)
		return NULL;
	const cau_ring_frame *frame = cau_half_choose(stream, sub, now_s);
	if (!frame)
		return NULL;
	uint64_t over = frame->sequence - sub->sequence;
	if (!frame->buffer || over == 0 || over > CAU_FRAME_THINNING) { // it has left the ring
		sub->wants_key = true;
		cau_half_fallen(h, stream, sub);
		return NULL;
	}
	if (sub->acknowledges && sub->in_flight > bound)
		return NULL;
	cau_half_steady(h, stream, sub);
	return take_frame(sub, stream, frame);
}

cau_buffer *cau_hosted_next_frame(cau_hosted *h, cau_subscriber *sub, double now_s)
{
	cau_buffer *buffer = NULL;
	bool wake = false;
	cau_stream *stream = &h->streams[sub->stream];
	size_t bound = (size_t)h->around->config->subscriber_bytes;
	pthread_mutex_lock(&h->mutex);
	if (!sub->topology_sent) {
		sub->topology_sent = sub->wants_key = true;
		buffer = cau_buffer_share(stream->topology);
	} else {
		if (sub->epoch != stream->epoch)
			sub->wants_key = true;
		if (!sub->wants_key)
			buffer = next_delta(h, stream, sub, now_s, bound);
		if (sub->wants_key && !(sub->acknowledges && sub->in_flight > bound))
			buffer = next_key(stream, sub, now_s, &wake);
	}
	pthread_mutex_unlock(&h->mutex);
	if (wake)
		cau_worker_pool_wake(h->around->pool, &h->task);
	return buffer;
}

bool cau_hosted_has_frame(cau_hosted *h, const cau_subscriber *sub)
{
	const cau_stream *stream = &h->streams[sub->stream];
	pthread_mutex_lock(&h->mutex);
	bool behind = !sub->topology_sent || sub->epoch != stream->epoch || sub->wants_key ||
	              sub->sequence < stream->newest;
	pthread_mutex_unlock(&h->mutex);
	return behind;
}

void cau_hosted_acknowledge(cau_hosted *h, cau_subscriber *sub, uint64_t epoch, uint64_t sequence)
{
	(void)h;
	if (epoch != sub->epoch || sequence > sub->sequence)
		return;
	sub->acknowledges = true;
	sub->in_flight = 0;
	for (size_t i = 0; i < 32; i++)
		if (sub->sent[i].sequence > sequence && sub->sent[i].sequence <= sub->sequence)
			sub->in_flight += sub->sent[i].bytes;
}

void cau_hosted_leave(cau_hosted *h, const cau_subscriber *sub)
{
	pthread_mutex_lock(&h->mutex);
	h->streams[sub->stream].subscribers--;
	cau_half_leave(&h->streams[sub->stream], sub);
	pthread_mutex_unlock(&h->mutex);
}
