// SPDX-License-Identifier: GPL-3.0-or-later
// The open profiles of a session. A profile is opened for a subscriber if no open one fits. A
// profile without subscribers is reused.
#include <math.h>
#include <stdalign.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "stream/internal.h"

static void close_stream(cau_stream *stream)
{
	cau_ring_clear(stream);
	cau_buffer_release(stream->topology);
	free(stream->half.storage);
	cau_shelf_give_back(stream->storage);
	*stream = (cau_stream){0};
}

void cau_streams_init(cau_streams *streams)
{
	pthread_mutex_init(&streams->mutex, NULL);
	streams->profile_shelf = cau_shelf_create();
	streams->opening_shelf = cau_shelf_create();
}

void cau_streams_finish(cau_streams *streams)
{
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		close_stream(&streams->stream[i]);
	cau_buffer_release(streams->topology);
	cau_shelf_release(streams->profile_shelf);
	cau_shelf_release(streams->opening_shelf);
	pthread_mutex_destroy(&streams->mutex);
}

uint32_t cau_streams_watched(cau_streams *streams)
{
	uint32_t channels = 0;
	pthread_mutex_lock(&streams->mutex);
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		if (streams->stream[i].used && streams->stream[i].subscribers > 0)
			channels |= streams->stream[i].def.channels;
	pthread_mutex_unlock(&streams->mutex);
	return channels;
}

// ---- finding a stream
// True if every client with this wish can read the stream. A client that reads meshoptimizer's
// codec reads plain numbers too.
static bool is_readable(const cau_stream *stream, const cau_stream_wish *wish)
{
	return stream->used && (stream->def.plain || !wish->plain);
}

// Returns the stream that fits the wish. Returns NULL if a new stream must be opened, or if no slot
// is free and no open stream is readable.
static cau_stream *find_stream(cau_streams *streams, const cau_stream_wish *wish)
{
	cau_stream *nearest = NULL, *any = NULL;
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++) {
		cau_stream *stream = &streams->stream[i];
		if (!is_readable(stream, wish))
			continue;
		any = any ? any : stream;
		bool fits = stream->def.channels == wish->channels && stream->def.step_m <= wish->step_m &&
		            stream->def.plain == wish->plain;
		if (fits && stream->rate_hz == wish->rate_hz)
			return stream;
		bool nearer = !nearest || fabs(stream->rate_hz - wish->rate_hz) <
		                              fabs(nearest->rate_hz - wish->rate_hz);
		if ((stream->def.channels & wish->channels) == wish->channels && nearer)
			nearest = stream;
	}
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		if (!streams->stream[i].used || streams->stream[i].subscribers == 0)
			// A slot is free, so a stream that fits can be opened.
			return NULL;
	return nearest ? nearest : any;
}

// Clears the remaining frames of the ring. Nothing was published without subscribers, so these
// frames are old.
static void wake_stream(cau_stream *stream)
{
	cau_buffer_release(stream->key.buffer);
	stream->key = (cau_ring_frame){0};
	stream->key_wanted = true;
}

// ---- opening a stream
// Rounds up to a multiple of the largest alignment, for parts that share one allocation.
static size_t aligned(size_t bytes)
{
	return (bytes + alignof(max_align_t) - 1) / alignof(max_align_t) * alignof(max_align_t);
}

static size_t profile_bytes(const cau_stream_def *def)
{
	return aligned(cau_frame_encoder_bytes(def)) + cau_frame_bytes_max(def);
}

static size_t topology_work_bytes(const cau_stream_def *def)
{
	return aligned(cau_topology_scratch_bytes(def)) + aligned(cau_topology_bytes_max(def)) +
	       (size_t)def->face_count;
}

// Returns a definition with the usual channels. A wish for more channels makes the memory larger.
static cau_stream_def usual_def(int32_t vertex_count, int32_t face_count)
{
	cau_stream_def def = cau_default_stream_def();
	def.vertex_count = vertex_count;
	def.face_count = face_count;
	return def;
}

size_t cau_streams_opening_bytes(int32_t vertex_count, int32_t face_count)
{
	cau_stream_def def = usual_def(vertex_count, face_count);
	return profile_bytes(&def) + topology_work_bytes(&def) + cau_topology_bytes_max(&def);
}

// Encodes the topology of a stream. Faces, layers and texture are coded once for a session.
static cau_status encode_topology(cau_streams *streams, const cau_stream_def *def,
                                  const cau_stream_shape *shape, cau_buffer **made,
                                  cau_error *error)
{
	size_t most = cau_topology_bytes_max(def), bytes = 0;
	unsigned char *scratch = cau_shelf_take(streams->opening_shelf, topology_work_bytes(def));
	if (!scratch)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a topology");
	unsigned char *encoded = scratch + aligned(cau_topology_scratch_bytes(def));
	uint8_t *layers = encoded + aligned(most);
	for (int32_t i = 0; i < shape->face_count; i++)
		layers[i] = (uint8_t)shape->face_layer[i];
	cau_topology topology = {.face = shape->face,
	                         .face_layer = layers,
	                         .texture = shape->texture,
	                         .rest_position = shape->rest_position};
	if (streams->topology && !def->plain) { // the kept topology is not plain
		topology.known = cau_buffer_bytes(streams->topology);
		topology.known_bytes = streams->topology->byte_count;
	}
	cau_status status =
		cau_topology_encode(def, streams->epoch, &topology, scratch, encoded, most, &bytes, error);
	if (!status)
		*made = cau_buffer_create(bytes, true);
	if (*made)
		memcpy(cau_buffer_bytes(*made), encoded, bytes);
	else if (!status)
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a topology");
	cau_shelf_give_back(scratch);
	return status;
}

// Keeps the topology, from which later ones are made.
static void keep_topology(cau_streams *streams, cau_buffer *topology)
{
	cau_buffer_release(streams->topology);
	streams->topology = topology;
}

cau_status cau_streams_stock(cau_streams *streams, const cau_stream_shape *shape, cau_error *error)
{
	cau_stream_def def = usual_def(shape->vertex_count, shape->face_count);
	cau_buffer *topology = NULL;
	if (!streams->profile_shelf || !streams->opening_shelf)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the shelves of a session");
	if (!streams->epoch)
		cau_streams_restart(streams); // no frame has epoch 0
	def.session = streams->session;
	cau_shelf_stock(streams->profile_shelf, profile_bytes(&def), 1);
	cau_shelf_stock(streams->opening_shelf, topology_work_bytes(&def), 1);
	cau_status status = encode_topology(streams, &def, shape, &topology, error);
	if (!status)
		keep_topology(streams, topology);
	return status;
}

static cau_status open_stream(cau_streams *streams, int slot, const cau_stream_wish *wish,
                              const cau_stream_shape *shape, cau_error *error)
{
	cau_stream made = {.used = true, .epoch = streams->epoch, .rate_hz = wish->rate_hz};
	made.def = cau_default_stream_def();
	made.def.session = streams->session;
	made.def.profile = (uint16_t)slot;
	made.def.channels = wish->channels;
	made.def.vertex_count = shape->vertex_count;
	made.def.face_count = shape->face_count;
	made.def.step_m = wish->step_m;
	made.def.plain = wish->plain;
	size_t bytes = cau_frame_encoder_bytes(&made.def);
	made.scratch_bytes = cau_frame_bytes_max(&made.def);
	cau_status status = cau_stream_def_check(&made.def, error);
	if (!status)
		made.storage = cau_shelf_take(streams->profile_shelf, profile_bytes(&made.def));
	if (made.storage)
		made.scratch = (unsigned char *)made.storage + aligned(bytes);
	else if (!status)
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a stream");
	if (!status)
		status = cau_frame_encoder_init(made.storage, bytes, &made.def, streams->epoch,
		                                &made.encoder, error);
	if (!status)
		status = encode_topology(streams, &made.def, shape, &made.topology, error);
	if (status) {
		close_stream(&made);
		return status;
	}
	if (!wish->plain)
		keep_topology(streams, cau_buffer_share(made.topology));
	pthread_mutex_lock(&streams->mutex);
	close_stream(&streams->stream[slot]);
	streams->stream[slot] = made;
	pthread_mutex_unlock(&streams->mutex);
	return CAU_OK;
}

// ---- joining a stream
// Counts the subscriber into a stream that fits. Returns NULL if the stream *slot must be opened
// for it.
static cau_stream *take_stream(cau_streams *streams, const cau_stream_wish *wish,
                               int32_t *subscribers, int *slot, bool *woken)
{
	*subscribers = 0;
	pthread_mutex_lock(&streams->mutex);
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		*subscribers += streams->stream[i].subscribers;
	cau_stream *stream = find_stream(streams, wish);
	if (stream && stream->subscribers == 0) {
		wake_stream(stream);
		*woken = true;
	}
	if (stream)
		stream->subscribers++;
	else
		while (*slot < CAU_STREAM_PROFILES_MAX && streams->stream[*slot].used &&
		       streams->stream[*slot].subscribers)
			++*slot;
	pthread_mutex_unlock(&streams->mutex);
	return stream;
}

cau_status cau_streams_join(cau_streams *streams, const cau_stream_wish *wish,
                            const cau_stream_shape *shape, const cau_stream **joined, bool *woken,
                            cau_error *error)
{
	int32_t subscribers;
	int slot = 0;
	*woken = false;
	cau_stream *stream = take_stream(streams, wish, &subscribers, &slot, woken);
	if (subscribers >= streams->subscribers_most) {
		if (stream)
			cau_streams_leave(streams,
			                  &(cau_subscriber){.stream = (int32_t)(stream - streams->stream)});
		return cau_fail(error, CAU_LIMIT, "",
		                "the session has the largest number of streams (setting max_subscribers)");
	}
	*joined = stream;
	if (stream)
		return CAU_OK;
	if (slot == CAU_STREAM_PROFILES_MAX)
		return cau_fail(
			error, CAU_LIMIT, "params.plain",
			"all %d stream profiles of the session are in use, and none of them is plain", slot);
	cau_status status = open_stream(streams, slot, wish, shape, error);
	*joined = &streams->stream[slot];
	if (!status) {
		pthread_mutex_lock(&streams->mutex);
		streams->stream[slot].subscribers = 1;
		pthread_mutex_unlock(&streams->mutex);
	}
	return status;
}
