// SPDX-License-Identifier: GPL-3.0-or-later
// The newest frames of a stream, each in a counted buffer that all its subscribers share.
#include <string.h>

#include "stream/internal.h"

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
