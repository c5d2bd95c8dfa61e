// SPDX-License-Identifier: GPL-3.0-or-later
// A reader of one session for the tests: its status and its frames. It decodes frames as
// protocol/idl/README.md says, with the protocol's codec and nothing of the server.
//
//     observer DOMAIN SESSION
//
// The line `state` on standard input requests the present state. It writes events as JSON objects,
// one a line, to standard output: status (each one), gone, state.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery.h"
#include "cautery/frame_codec.h"
#include "cautery/topology_codec.h"
#include "console.h"
#include "link.h"

#define PERIOD_S 0.01

enum { HELD_MOST = 256, TAKEN_MOST = 32 };

typedef struct held {
	uint64_t epoch, base;
	size_t byte_count;
	void *bytes; // NULL if the entry is free
} held;

typedef struct observer {
	const char *session;
	dds_entity_t participant, status_reader, topology_reader, key_reader, delta_reader;
	cau_stream_def def;
	void *storage;
	cau_frame_decoder *decoder; // NULL before the first frame
	held held[HELD_MOST];       // deltas that arrived before their base state
	uint32_t topology_hash;
	int statuses, topologies, keys, deltas, refused, foreign;
	bool state_asked; // the state is printed at the end of the period
} observer;

// ---- decoding
static uint32_t hashed(uint32_t hash, const void *bytes, size_t count)
{
	for (size_t i = 0; i < count; i++)
		hash = (hash ^ ((const uint8_t *)bytes)[i]) * 16777619u; // FNV-1a
	return hash;
}

static cau_stream_def definition(const cautery_Frame *frame)
{
	cau_stream_def def = {.session = frame->session_number,
	                      .profile = frame->stream.profile,
	                      .channels = frame->stream.channels,
	                      .vertex_count = (int32_t)frame->stream.vertex_count,
	                      .face_count = (int32_t)frame->stream.face_count,
	                      .step_m = frame->stream.step_m,
	                      .stress_step_pa = frame->stream.stress_step_pa};
	memcpy(def.origin_m, frame->stream.origin_m, sizeof def.origin_m);
	return def;
}

// Makes a decoder for the frame's stream, if the stream is not the one before.
static void follow_stream(observer *o, const cautery_Frame *frame)
{
	cau_error error = {0};
	cau_stream_def def = definition(frame);
	if (o->decoder && memcmp(&def, &o->def, sizeof def) == 0)
		return;
	free(o->storage);
	o->def = def;
	o->decoder = NULL;
	o->storage = malloc(cau_frame_decoder_bytes(&def));
	if (!o->storage || cau_frame_decoder_init(o->storage, cau_frame_decoder_bytes(&def), &def,
	                                          &o->decoder, &error))
		give_up(error.reason);
}

static void decode(observer *o, const void *bytes, size_t byte_count)
{
	cau_error error = {0};
	if (cau_frame_decode(o->decoder, bytes, byte_count, &error))
		o->refused++;
}

static void hold(observer *o, const cautery_Frame *frame)
{
	held *slot = &o->held[frame->base_sequence % HELD_MOST];
	free(slot->bytes);
	*slot = (held){frame->epoch, frame->base_sequence, frame->bytes._length,
	               malloc(frame->bytes._length)};
	if (slot->bytes)
		memcpy(slot->bytes, frame->bytes._buffer, frame->bytes._length);
}

// Applies the held deltas that fit now.
static void catch_up(observer *o)
{
	for (;;) {
		const cau_stream_state *state = cau_frame_decoder_state(o->decoder);
		held *next = &o->held[state->sequence % HELD_MOST];
		if (!state->synced || !next->bytes || next->epoch != state->epoch ||
		    next->base != state->sequence)
			return;
		decode(o, next->bytes, next->byte_count);
		free(next->bytes);
		next->bytes = NULL;
	}
}

static void take_key(observer *o, const cautery_Frame *frame)
{
	const cau_stream_state *state = cau_frame_decoder_state(o->decoder);
	o->keys++;
	bool newer = frame->sequence_number > state->sequence;
	if (!state->synced || state->epoch != frame->epoch || newer)
		decode(o, frame->bytes._buffer, frame->bytes._length);
	catch_up(o);
}

static void take_delta(observer *o, const cautery_Frame *frame)
{
	const cau_stream_state *state = cau_frame_decoder_state(o->decoder);
	o->deltas++;
	if (state->synced && state->epoch == frame->epoch && frame->base_sequence < state->sequence)
		return; // the state is newer already
	hold(o, frame);
	catch_up(o);
}

static void take_topology(observer *o, const cautery_Frame *frame)
{
	cau_error error = {0};
	size_t faces = frame->stream.face_count, vertices = frame->stream.vertex_count;
	cau_topology_arrays arrays = {malloc(faces * 3 * sizeof(int32_t)), malloc(faces),
	                              malloc(faces * 6 * sizeof(float)),
	                              malloc(vertices * 3 * sizeof(int32_t)), false};
	void *scratch = malloc(cau_topology_scratch_bytes(&o->def));
	o->topologies++;
	if (cau_topology_decode(&o->def, frame->bytes._buffer, frame->bytes._length, scratch, &arrays,
	                        &error)) {
		o->refused++;
	} else {
		uint32_t hash = hashed(2166136261u, arrays.face, faces * 3 * sizeof(int32_t));
		hash = hashed(hash, arrays.face_layer, faces);
		o->topology_hash = hashed(hash, arrays.rest, vertices * 3 * sizeof(int32_t));
	}
	free(arrays.face);
	free(arrays.face_layer);
	free(arrays.texture);
	free(arrays.rest);
	free(scratch);
}

static void take_frame(void *user, const void *sample)
{
	observer *o = user;
	const cautery_Frame *frame = sample;
	if (strcmp(frame->session, o->session) != 0) {
		o->foreign++;
		return;
	}
	follow_stream(o, frame);
	if (frame->kind == cautery_KEY_FRAME)
		take_key(o, frame);
	else if (frame->kind == cautery_DELTA)
		take_delta(o, frame);
	else
		take_topology(o, frame);
}

// ---- reading
static void tell_status(const cautery_SessionStatus *s)
{
	static const char *const states[] = {"starting", "running", "paused", "faulted"};
	printf("{\"event\":\"status\",\"session\":\"%s\",\"scene\":\"%s\",\"state\":\"%s\","
	       "\"fault\":\"%s\",\"tick\":%llu,\"time_s\":%.17g,\"step_s\":%.17g,\"speed\":%.17g,"
	       "\"realtime_factor\":%.17g,\"epoch\":\"%016llx\",\"vertex_count\":%u,"
	       "\"face_count\":%u,\"tool_count\":%u,\"subscriber_count\":%u,\"refused\":%llu,"
	       "\"steps\":%llu}\n",
	       s->session, s->scene, states[s->state], s->fault, (unsigned long long)s->tick, s->time_s,
	       s->step_s, s->speed, s->realtime_factor, (unsigned long long)s->epoch, s->vertex_count,
	       s->face_count, s->tool_count, s->subscriber_count, (unsigned long long)s->refused,
	       (unsigned long long)s->steps);
}

static void read_status(observer *o)
{
	void *samples[TAKEN_MOST] = {NULL};
	dds_sample_info_t infos[TAKEN_MOST];
	int count = dds_take(o->status_reader, samples, infos, TAKEN_MOST, TAKEN_MOST);
	for (int i = 0; i < count; i++) {
		const cautery_SessionStatus *status = samples[i];
		if (infos[i].valid_data) {
			o->foreign += strcmp(status->session, o->session) != 0;
			o->statuses++;
			tell_status(status);
		}
		if (infos[i].instance_state != DDS_IST_ALIVE)
			printf("{\"event\":\"gone\"}\n");
	}
	if (count > 0)
		dds_return_loan(o->status_reader, samples, count);
}

static void tell_state(const observer *o)
{
	const cau_stream_state *s = o->decoder ? cau_frame_decoder_state(o->decoder) : NULL;
	uint32_t hash = 2166136261u;
	if (s && s->synced) {
		hash = hashed(hash, s->quantised, (size_t)o->def.vertex_count * 3 * sizeof(int32_t));
		hash = hashed(hash, s->face_mask, ((size_t)o->def.face_count + 31) / 32 * sizeof(uint32_t));
	}
	printf("{\"event\":\"state\",\"synced\":%s,\"epoch\":\"%016llx\",\"sequence\":%llu,"
	       "\"tick\":%llu,\"hash\":%u,\"topology_hash\":%u,\"statuses\":%d,\"topologies\":%d,"
	       "\"keys\":%d,\"deltas\":%d,\"refused\":%d,\"foreign\":%d}\n",
	       s && s->synced ? "true" : "false", (unsigned long long)(s ? s->epoch : 0),
	       (unsigned long long)(s ? s->sequence : 0), (unsigned long long)(s ? s->tick : 0), hash,
	       o->topology_hash, o->statuses, o->topologies, o->keys, o->deltas, o->refused,
	       o->foreign);
}

static void obey(void *user, const char *line)
{
	observer *o = user;
	if (strcmp(line, "state") == 0)
		o->state_asked = true;
}

int main(int argument_count, char **arguments)
{
	observer o = {0};
	console c = {.kept_bytes = 0};
	if (argument_count != 3) {
		fprintf(stderr, "usage: observer DOMAIN SESSION\n");
		return 2;
	}
	setvbuf(stdout, NULL, _IOLBF, 0);
	o.session = arguments[2];
	o.participant = checked(dds_create_participant((uint32_t)atoi(arguments[1]), NULL, NULL));
	dds_entity_t subscriber = subscriber_of(o.participant, o.session);
	const dds_durability_kind_t kept = DDS_DURABILITY_TRANSIENT_LOCAL;
	o.status_reader =
		native_reader(subscriber, &cautery_SessionStatus_desc, "cautery/session_status", kept, 1);
	o.topology_reader = native_reader(subscriber, &cautery_Frame_desc, "cautery/topology", kept, 1);
	o.key_reader = native_reader(subscriber, &cautery_Frame_desc, "cautery/key_frame", kept, 1);
	o.delta_reader = native_reader(subscriber, &cautery_Frame_desc, "cautery/delta",
	                               DDS_DURABILITY_VOLATILE, HELD_MOST);
	double next_s = 0;
	while (console_listen(&c, next_s - clock_s(CLOCK_MONOTONIC), obey, &o)) {
		if (clock_s(CLOCK_MONOTONIC) < next_s)
			continue;
		next_s = clock_s(CLOCK_MONOTONIC) + PERIOD_S;
		read_status(&o);
		take_each(o.topology_reader, take_frame, &o);
		take_each(o.key_reader, take_frame, &o);
		take_each(o.delta_reader, take_frame, &o);
		if (o.state_asked)
			tell_state(&o);
		o.state_asked = false;
	}
	dds_delete(o.participant);
	for (int i = 0; i < HELD_MOST; i++)
		free(o.held[i].bytes);
	free(o.storage);
	return 0;
}
