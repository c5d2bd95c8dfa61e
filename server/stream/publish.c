// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the frames that are due, once for each profile that has subscribers.
#include <math.h>
#include <sys/random.h>

#include "stream/internal.h"

// Share of a frame's period by which the frame may be early. So nearly equal rates of ticks and
// frames do not beat.
#define DUE_EARLY 0.25

static uint64_t random_epoch(void)
{
	uint64_t epoch = 0;
	while (epoch == 0)
		if (getrandom(&epoch, sizeof epoch, 0) != sizeof epoch)
			epoch = (uint64_t)cau_wall_us();
	return epoch;
}

uint64_t cau_streams_restart(cau_streams *streams)
{
	streams->epoch = random_epoch();
	pthread_mutex_lock(&streams->mutex);
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++) {
		cau_stream *stream = &streams->stream[i];
		if (!stream->used)
			continue;
		cau_ring_clear(stream);
		stream->epoch = streams->epoch;
		cau_frame_encoder_restart(stream->encoder, streams->epoch);
	}
	pthread_mutex_unlock(&streams->mutex);
	return streams->epoch;
}

// Cancels the request for a key frame, so that the worker does not try again and again while a
// subscriber waits.
static void give_up_key(cau_streams *streams, cau_stream *stream)
{
	pthread_mutex_lock(&streams->mutex);
	stream->key_wanted = false;
	pthread_mutex_unlock(&streams->mutex);
}

// Advances the chain of deltas by a frame. The epoch's first frame is a key frame.
static cau_status publish_frame(cau_streams *streams, cau_stream *stream,
                                const cau_stream_sample *sample, bool *made, cau_error *error)
{
	size_t bytes = 0;
	bool first = cau_frame_encoder_sequence(stream->encoder) == 0;
	cau_status status = cau_frame_encode(stream->encoder, sample, stream->scratch,
	                                     stream->scratch_bytes, &bytes, error);
	if (status) {
		give_up_key(streams, stream);
		return status;
	}
	cau_buffer *buffer = cau_ring_take(stream, bytes);
	uint64_t sequence = cau_frame_encoder_sequence(stream->encoder);
	if (!buffer)
		return CAU_OK;
	if (first)
		cau_ring_put_key(streams, stream, buffer, sequence);
	else
		cau_ring_put_delta(streams, stream, buffer, sequence);
	cau_half_publish(streams, stream);
	*made = true;
	return CAU_OK;
}

static cau_status publish_key(cau_streams *streams, cau_stream *stream, bool *made,
                              cau_error *error)
{
	size_t bytes = 0;
	cau_status status = cau_frame_encode_key(stream->encoder, stream->scratch,
	                                         stream->scratch_bytes, &bytes, error);
	if (status) {
		give_up_key(streams, stream);
		return status;
	}
	cau_buffer *buffer = cau_ring_take(stream, bytes);
	if (!buffer)
		return CAU_OK;
	cau_ring_put_key(streams, stream, buffer, cau_frame_encoder_sequence(stream->encoder));
	*made = true;
	return CAU_OK;
}

static bool is_due(const cau_stream *stream, const cau_stream_moment *moment)
{
	if (moment->all || cau_frame_encoder_sequence(stream->encoder) == 0)
		return true;
	return moment->moving && moment->now_s >= stream->next_s - DUE_EARLY / stream->rate_hz;
}

static cau_status serve_stream(cau_streams *streams, cau_stream *stream,
                               const cau_stream_moment *moment, const cau_stream_sample **sample,
                               bool *made, cau_error *error)
{
	cau_status status = CAU_OK;
	pthread_mutex_lock(&streams->mutex);
	bool watched = stream->used && stream->subscribers > 0, key = stream->key_wanted;
	pthread_mutex_unlock(&streams->mutex);
	if (!watched)
		return CAU_OK;
	if (is_due(stream, moment)) {
		if (!*sample)
			*sample = moment->sample(moment->user);
		stream->next_s = fmax(stream->next_s + 1 / stream->rate_hz, moment->now_s);
		status = publish_frame(streams, stream, *sample, made, error);
	}
	if (key) {
		cau_status of_key = publish_key(streams, stream, made, status ? NULL : error);
		status = status ? status : of_key;
	}
	return status;
}

cau_status cau_streams_publish(cau_streams *streams, const cau_stream_moment *moment, bool *made,
                               cau_error *error)
{
	const cau_stream_sample *sample = NULL;
	cau_status first = CAU_OK;
	*made = false;
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++) {
		cau_status status =
			serve_stream(streams, &streams->stream[i], moment, &sample, made, first ? NULL : error);
		first = first ? first : status;
	}
	return first;
}
