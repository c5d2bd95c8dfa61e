// SPDX-License-Identifier: GPL-3.0-or-later
// Frames: encoded once for each profile, kept in a short ring, shared by every subscriber.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "cautery/topology_codec.h"
#include "hosted_session/internal.h"

#define DUE_EARLY 0.25 // of a period: ticks and rates that nearly agree do not beat

static uint64_t random_epoch(void)
{
	uint64_t epoch = 0;
	while (epoch == 0)
		if (getrandom(&epoch, sizeof epoch, 0) != sizeof epoch)
			epoch = (uint64_t)cau_wall_us();
	return epoch;
}

static void clear_ring(cau_stream *stream)
{
	for (int i = 0; i < RING_FRAMES; i++)
		cau_buffer_release(stream->ring[i].buffer);
	cau_buffer_release(stream->key.buffer);
	cau_half_clear(stream);
	memset(stream->ring, 0, sizeof stream->ring);
	stream->key = (cau_ring_frame){0};
	stream->newest = 0;
}

void cau_streams_restart(cau_hosted *h)
{
	h->epoch = random_epoch();
	h->dirty = true;
	pthread_mutex_lock(&h->mutex);
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++) {
		cau_stream *stream = &h->streams[i];
		if (!stream->used)
			continue;
		clear_ring(stream);
		stream->epoch = h->epoch;
		cau_frame_encoder_restart(stream->encoder, h->epoch);
	}
	pthread_mutex_unlock(&h->mutex);
}

static void close_stream(cau_stream *stream)
{
	clear_ring(stream);
	cau_half_finish(stream);
	cau_buffer_release(stream->topology);
	free(stream->storage);
	free(stream->scratch);
	*stream = (cau_stream){0};
}

void cau_streams_destroy(cau_hosted *h)
{
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		close_stream(&h->streams[i]);
}

// ---- publishing
static void fill_tools(cau_hosted *h, const cau_frame *frame, cau_stream_tool *tools)
{
	for (int32_t i = 0; i < frame->tool_count; i++) {
		const cau_tool_state *from = &frame->tools[i];
		cau_drive drive = {.energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
		bool known = cau_decide_find(h, from->name, &drive);
		cau_stream_tool *to = &tools[i];
		*to = (cau_stream_tool){
			.shape = from->definition.shape,
			.pose = from->pose,
			.jaw = from->jaw,
			.tip_temperature_c = from->tip_temperature_c,
			.energy_j = from->energy_j,
			.sequence = from->sequence,
			.driver = drive.driver.client,
			.energized = from->energized && (!known || drive.enabled),
			.grasping = from->grasping,
			.frozen = drive.frozen,
			.energy_off = (uint8_t)drive.energy_off,
			.grasped_vertices = (uint16_t)fmin(from->grasped_vertices, UINT16_MAX),
			.contact_vertices = (uint16_t)fmin(from->contact_vertices, UINT16_MAX),
			.touched_layers = (uint16_t)from->touched_layers,
		};
		memcpy(to->name, from->name, sizeof to->name);
		memcpy(to->force_n, from->force_n, sizeof to->force_n);
		memcpy(to->torque_nm, from->torque_nm, sizeof to->torque_nm);
	}
}

static cau_stream_statistics fill_statistics(const cau_hosted *h, const cau_statistics *from)
{
	cau_stream_statistics to = {
		.realtime_factor = (float)h->realtime_factor,
		.step_cost_s = (float)h->step_cost_s,
		.residual = (float)from->residual,
		.deferred_max_s = (float)from->deferred_max_s,
		.iterations = (uint32_t)from->iterations,
		.backtracks = (uint32_t)from->backtracks,
		.inverted = (uint32_t)from->inverted,
		.edges_parted = (uint32_t)from->edges_parted,
		.elements_removed = (uint32_t)from->elements_removed,
		.pending_downdates = (uint32_t)from->pending_downdates,
		.refactorisations = (uint32_t)from->refactorisations,
		.contacts = (uint32_t)from->contacts,
		.frozen_vertices = (uint32_t)from->frozen_vertices,
		.refused_commands = h->refused_commands,
		.energy_gain_j = (float)from->energy_gain_j,
	};
	for (int i = 0; i < CAU_STREAM_STAGES; i++)
		to.stage_s[i] = (float)from->seconds[i];
	return to;
}

cau_buffer *cau_stream_take(const cau_stream *stream, size_t bytes)
{
	cau_buffer *buffer = cau_buffer_create(bytes, true);
	if (buffer)
		memcpy(cau_buffer_bytes(buffer), stream->scratch, bytes);
	return buffer;
}

static void put_delta(cau_hosted *h, cau_stream *stream, cau_buffer *buffer, uint64_t sequence)
{
	pthread_mutex_lock(&h->mutex);
	cau_ring_frame *slot = &stream->ring[sequence % RING_FRAMES];
	cau_buffer_release(slot->buffer);
	*slot = (cau_ring_frame){sequence, buffer};
	stream->newest = sequence;
	stream->newest_s = cau_monotonic_s();
	h->counts.frames++;
	h->counts.frame_bytes += buffer->byte_count;
	pthread_mutex_unlock(&h->mutex);
}

static void put_key(cau_hosted *h, cau_stream *stream, cau_buffer *buffer, uint64_t sequence)
{
	pthread_mutex_lock(&h->mutex);
	cau_buffer_release(stream->key.buffer);
	stream->key = (cau_ring_frame){sequence, buffer};
	stream->newest = sequence;
	stream->newest_s = cau_monotonic_s();
	stream->key_wanted = false;
	h->counts.key_frames++;
	pthread_mutex_unlock(&h->mutex);
}

static void encoding_failed(cau_hosted *h, cau_stream *stream, const cau_error *error)
{
	if (cau_decided_state(h) != CAU_SESSION_FAULTED)
		cau_hosted_fault(h, error);
	pthread_mutex_lock(&h->mutex);
	stream->key_wanted = false;
	pthread_mutex_unlock(&h->mutex);
}

// Advances the chain by a frame; the epoch's first is a key frame.
static bool publish_frame(cau_hosted *h, cau_stream *stream, const cau_stream_sample *sample)
{
	cau_error error = {0};
	size_t bytes = 0;
	bool first = cau_frame_encoder_sequence(stream->encoder) == 0;
	if (cau_frame_encode(stream->encoder, sample, stream->scratch, stream->scratch_bytes, &bytes,
	                     &error)) {
		encoding_failed(h, stream, &error);
		return false;
	}
	cau_buffer *buffer = cau_stream_take(stream, bytes);
	uint64_t sequence = cau_frame_encoder_sequence(stream->encoder);
	if (!buffer)
		return false;
	if (first)
		put_key(h, stream, buffer, sequence);
	else
		put_delta(h, stream, buffer, sequence);
	return true;
}

static void publish_key(cau_hosted *h, cau_stream *stream)
{
	cau_error error = {0};
	size_t bytes = 0;
	if (cau_frame_encode_key(stream->encoder, stream->scratch, stream->scratch_bytes, &bytes,
	                         &error)) {
		encoding_failed(h, stream, &error);
		return;
	}
	cau_buffer *buffer = cau_stream_take(stream, bytes);
	if (buffer)
		put_key(h, stream, buffer, cau_frame_encoder_sequence(stream->encoder));
}

typedef struct published {
	cau_frame frame;
	cau_stream_tool tools[CAU_MAX_TOOLS];
	cau_stream_statistics statistics;
	cau_stream_sample sample;
} published;

static void fill_sample(cau_hosted *h, published *p)
{
	int state = cau_decided_state(h);
	cau_session_frame(h->core, &p->frame);
	fill_tools(h, &p->frame, p->tools);
	p->statistics = fill_statistics(h, &p->frame.statistics);
	p->sample = (cau_stream_sample){
		.tick = p->frame.tick,
		.time_s = p->frame.time_s,
		.published_us = (uint64_t)(cau_monotonic_s() * 1e6),
		.flags = (uint16_t)((state == CAU_SESSION_PAUSED ? CAU_FRAME_PAUSED : 0) |
	                        (state == CAU_SESSION_FAULTED ? CAU_FRAME_FAULTED : 0)),
		.position = p->frame.position,
		.vertex_visible = p->frame.vertex_visible,
		.face_mask = p->frame.face_mask,
		.tool_count = p->frame.tool_count,
		.tools = p->tools,
		.statistics = &p->statistics,
	};
	memcpy(p->sample.scalar, p->frame.scalar, sizeof p->sample.scalar);
}

static bool is_due(const cau_hosted *h, const cau_stream *stream, double now_s)
{
	if (h->dirty || cau_frame_encoder_sequence(stream->encoder) == 0)
		return true;
	bool moving = cau_decided_state(h) == CAU_SESSION_RUNNING || h->logic->steps_left;
	return moving && now_s >= stream->next_s - DUE_EARLY / stream->rate_hz;
}

static bool serve_stream(cau_hosted *h, cau_stream *stream, published *p, bool *filled,
                         double now_s)
{
	pthread_mutex_lock(&h->mutex);
	bool watched = stream->used && stream->subscribers > 0, key = stream->key_wanted;
	pthread_mutex_unlock(&h->mutex);
	if (!watched)
		return false;
	bool due = is_due(h, stream, now_s);
	if (due) {
		if (!*filled)
			fill_sample(h, p);
		*filled = true;
		stream->next_s = fmax(stream->next_s + 1 / stream->rate_hz, now_s);
		due = publish_frame(h, stream, &p->sample);
		if (due)
			cau_half_publish(h, stream);
	}
	if (key)
		publish_key(h, stream);
	return due || key;
}

// What costs the core work of its own is made as long as somebody watches it.
static void follow_channels(cau_hosted *h)
{
	uint32_t channels = 0;
	pthread_mutex_lock(&h->mutex);
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		if (h->streams[i].used && h->streams[i].subscribers > 0)
			channels |= h->streams[i].def.channels;
	pthread_mutex_unlock(&h->mutex);
	cau_session_watch(h->core, channels);
}

void cau_streams_publish(cau_hosted *h, double now_s)
{
	published p;
	bool filled = false, any = false;
	follow_channels(h);
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		any = serve_stream(h, &h->streams[i], &p, &filled, now_s) || any;
	h->dirty = false;
	if (any)
		h->around->sink.frames(h->around->sink.user);
}

// ---- joining
static cau_stream *find_stream(cau_hosted *h, const cau_order *order)
{
	cau_stream *nearest = NULL;
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++) {
		cau_stream *stream = &h->streams[i];
		if (!stream->used)
			continue;
		bool fits = stream->def.channels == order->as.join.channels &&
		            stream->def.step_m <= order->as.join.step_m;
		if (fits && stream->rate_hz == order->as.join.rate_hz)
			return stream;
		bool nearer = !nearest || fabs(stream->rate_hz - order->as.join.rate_hz) <
		                              fabs(nearest->rate_hz - order->as.join.rate_hz);
		if ((stream->def.channels & order->as.join.channels) == order->as.join.channels && nearer)
			nearest = stream;
	}
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		if (!h->streams[i].used || h->streams[i].subscribers == 0)
			return NULL; // a slot is free
	return nearest ? nearest : &h->streams[0];
}

static cau_status encode_topology(cau_hosted *h, cau_stream *stream, cau_error *error)
{
	size_t most = cau_topology_bytes_max(&stream->def), bytes = 0;
	void *scratch = malloc(cau_topology_scratch_bytes(&stream->def));
	uint8_t *layers = malloc((size_t)h->info.face_count + 1);
	cau_buffer *buffer = cau_buffer_create(most, true);
	cau_status status = CAU_NO_MEMORY;
	if (scratch && layers && buffer) {
		for (int32_t i = 0; i < h->info.face_count; i++)
			layers[i] = (uint8_t)h->info.face_layer[i];
		cau_topology topology = {h->info.face, layers, h->info.texture, h->info.rest_position};
		status = cau_topology_encode(&stream->def, h->epoch, &topology, scratch,
		                             cau_buffer_bytes(buffer), most, &bytes, error);
	}
	if (!status) {
		stream->topology = cau_buffer_create(bytes, true);
		if (stream->topology)
			memcpy(cau_buffer_bytes(stream->topology), cau_buffer_bytes(buffer), bytes);
	}
	cau_buffer_release(buffer);
	free(layers);
	free(scratch);
	return stream->topology ? CAU_OK : status ? status : CAU_NO_MEMORY;
}

static cau_status open_stream(cau_hosted *h, int slot, const cau_order *order, cau_error *error)
{
	cau_stream made = {.used = true, .epoch = h->epoch, .rate_hz = order->as.join.rate_hz};
	made.def = cau_default_stream_def();
	made.def.session = h->number;
	made.def.profile = (uint16_t)slot;
	made.def.channels = order->as.join.channels;
	made.def.vertex_count = h->info.vertex_count;
	made.def.face_count = h->info.face_count;
	made.def.step_m = order->as.join.step_m;
	size_t bytes = cau_frame_encoder_bytes(&made.def);
	made.scratch_bytes = cau_frame_bytes_max(&made.def);
	made.storage = malloc(bytes);
	made.scratch = malloc(made.scratch_bytes);
	cau_status status = cau_stream_def_check(&made.def, error);
	if (!status && (!made.storage || !made.scratch))
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a stream");
	if (!status)
		status =
			cau_frame_encoder_init(made.storage, bytes, &made.def, h->epoch, &made.encoder, error);
	if (!status)
		status = encode_topology(h, &made, error);
	if (status) {
		close_stream(&made);
		return status;
	}
	pthread_mutex_lock(&h->mutex);
	close_stream(&h->streams[slot]);
	h->streams[slot] = made;
	pthread_mutex_unlock(&h->mutex);
	return CAU_OK;
}

// Nothing was published while nobody watched: what the ring still holds is of another time.
static void wake_stream(cau_hosted *h, cau_stream *stream)
{
	cau_buffer_release(stream->key.buffer);
	stream->key = (cau_ring_frame){0};
	stream->key_wanted = true;
	h->dirty = true;
}

// A stream that fits, opened if need be; the subscriber is counted already when it returns.
static cau_status take_stream(cau_hosted *h, const cau_order *order, cau_stream **taken,
                              cau_error *error)
{
	int32_t subscribers = 0;
	int slot = 0;
	pthread_mutex_lock(&h->mutex);
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		subscribers += h->streams[i].subscribers;
	cau_stream *stream = find_stream(h, order);
	if (stream && stream->subscribers == 0)
		wake_stream(h, stream);
	if (stream)
		stream->subscribers++;
	else
		while (h->streams[slot].used && h->streams[slot].subscribers)
			slot++;
	pthread_mutex_unlock(&h->mutex);
	if (subscribers >= h->around->config->max_subscribers) {
		if (stream)
			cau_hosted_leave(h, &(cau_subscriber){.stream = (int32_t)(stream - h->streams)});
		return cau_fail(error, CAU_LIMIT, "", "the session has as many streams as it may");
	}
	*taken = stream;
	if (stream)
		return CAU_OK;
	cau_status status = open_stream(h, slot, order, error);
	*taken = &h->streams[slot];
	if (!status) {
		pthread_mutex_lock(&h->mutex);
		h->streams[slot].subscribers = 1;
		pthread_mutex_unlock(&h->mutex);
	}
	return status;
}

void cau_apply_join(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_stream *stream = NULL;
	if (take_stream(h, order, &stream, &error)) {
		cau_answer_fail(order, &error, 0);
		return;
	}
	cau_wire_stream_description result = {.session_number = h->number,
	                                      .profile = stream->def.profile,
	                                      .epoch = h->epoch,
	                                      .rate_hz = stream->rate_hz,
	                                      .channels = stream->def.channels,
	                                      .vertex_count = stream->def.vertex_count,
	                                      .face_count = stream->def.face_count,
	                                      .step_m = stream->def.step_m,
	                                      .stress_step_pa = stream->def.stress_step_pa};
	memcpy(result.session, h->id, sizeof result.session);
	memcpy(result.origin_m, stream->def.origin_m, sizeof result.origin_m);
	cau_outcome outcome = {.joined = h, .stream = stream->def.profile};
	char *text = cau_answer_text(order->reply.method, &result, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	if (!text)
		cau_hosted_leave(h, &(cau_subscriber){.stream = stream->def.profile});
	cau_reply_answer(&order->reply, &outcome);
	free(text);
	free(order);
}
