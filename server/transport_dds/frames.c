// SPDX-License-Identifier: GPL-3.0-or-later
// A session's frames: cautery/topology, cautery/key_frame and cautery/delta. While any of the three
// has a reader, the transport is one subscriber of the session, like a WebSocket connection.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/frame_codec.h"
#include "transport_dds/internal.h"

#define RATE_HZ 60
#define KEY_PERIOD_S 2.0
#define LOOK_S 1.0       // time between checks for a requested key frame that has not come
#define LOST_PAUSE_S 0.1 // time from a frame that the writer could not take to a key frame
#define RETRY_S 1.0

// ---- writing
static cautery_Frame describe(const cau_dds_session *session, const cau_frame_header *header)
{
	const cau_wire_stream_description *d = &session->stream.description;
	cautery_Frame sample = {
		.session_number = header->session,
		.kind = header->kind == CAU_FRAME_KEY     ? cautery_KEY_FRAME
	            : header->kind == CAU_FRAME_DELTA ? cautery_DELTA
	                                              : cautery_TOPOLOGY,
		.epoch = header->epoch,
		.sequence_number = header->sequence,
		.base_sequence = header->base_sequence,
		.tick = header->tick,
		.time_s = header->time_s,
		.stream = {.profile = header->profile,
	               .channels = d->channels,
	               .rate_hz = d->rate_hz,
	               .vertex_count = (uint32_t)d->vertex_count,
	               .face_count = (uint32_t)d->face_count,
	               .step_m = d->step_m,
	               .stress_step_pa = d->stress_step_pa},
	};
	snprintf(sample.session, sizeof sample.session, "%s", cau_hosted_id(session->hosted));
	memcpy(sample.stream.origin_m, d->origin_m, sizeof sample.stream.origin_m);
	return sample;
}

static dds_entity_t writer_of(const cau_dds_stream *stream, cautery_FrameKind kind)
{
	return kind == cautery_KEY_FRAME ? stream->key.writer
	       : kind == cautery_DELTA   ? stream->delta.writer
	                                 : stream->topology.writer;
}

// Writes the frame and releases it. If the writer cannot take it, the next key frame repairs the
// stream.
static void write_frame(cau_dds_session *session, cau_buffer *frame, double now_s)
{
	cau_dds_stream *stream = &session->stream;
	cau_frame_header header;
	unsigned char *bytes = cau_buffer_bytes(frame);
	if (cau_frame_header_read(bytes, frame->byte_count, &header, NULL)) {
		cau_buffer_release(frame);
		return;
	}
	cautery_Frame sample = describe(session, &header);
	sample.bytes = (dds_sequence_octet){(uint32_t)frame->byte_count, (uint32_t)frame->byte_count,
	                                    bytes, false};
	bool written = dds_write(writer_of(stream, sample.kind), &sample) == DDS_RETCODE_OK;
	if (!written) {
		stream->key_due_s = now_s + LOST_PAUSE_S;
		stream->chain.topology_sent &= sample.kind != cautery_TOPOLOGY;
	} else if (sample.kind == cautery_KEY_FRAME) {
		stream->key_epoch = header.epoch;
		stream->key_sequence = header.sequence;
		stream->key_due_s = now_s + KEY_PERIOD_S;
	}
	cau_buffer_release(frame);
}

// True if the last key frame, which late joiners get, has an older state than the last delta.
static bool key_is_old(const cau_dds_stream *stream)
{
	return stream->key_epoch != stream->chain.epoch ||
	       stream->key_sequence != stream->chain.sequence;
}

// Requests a key frame outside the chain of deltas. The chain continues, so that readers that
// follow it need no key frame.
static void want_key(cau_dds_stream *stream)
{
	const cau_subscriber *chain = &stream->chain;
	stream->keys = (cau_subscriber){.stream = chain->stream,
	                                .topology_sent = true,
	                                .has_key = !stream->key_forced,
	                                .wants_key = true,
	                                .epoch = chain->epoch,
	                                // The key frame must have this state or a newer one.
	                                .sequence = chain->sequence - 1,
	                                .key_asked_s = -INFINITY};
	stream->key_wanted = stream->key_forced = false;
}

static double write_new(cau_dds_session *session, double now_s)
{
	cau_dds_stream *stream = &session->stream;
	cau_buffer *frame;
	while ((frame = cau_hosted_next_frame(session->hosted, &stream->chain, now_s)))
		write_frame(session, frame, now_s);
	if (!stream->chain.has_key || stream->chain.wants_key)
		return now_s + LOOK_S; // the key frame on its way serves all readers
	bool due = key_is_old(stream) && now_s >= stream->key_due_s;
	if (due || stream->key_wanted)
		want_key(stream);
	if (stream->keys.wants_key)
		frame = cau_hosted_next_frame(session->hosted, &stream->keys, now_s);
	if (frame)
		write_frame(session, frame, now_s);
	if (stream->keys.wants_key)
		return now_s + LOOK_S;
	return key_is_old(stream) ? stream->key_due_s : INFINITY;
}

// ---- joining and leaving
// True if any outlet has readers. Also notes new readers, which have only the kept samples so far.
static bool has_readers(cau_dds_stream *stream)
{
	cau_dds_outlet *outlets[] = {&stream->topology, &stream->key, &stream->delta};
	bool any = false;
	for (size_t i = 0; i < sizeof outlets / sizeof outlets[0]; i++) {
		stream->key_wanted |= cau_dds_take_newcomers(outlets[i]);
		any |= cau_dds_is_read(outlets[i]);
	}
	return any;
}

static void join(cau_dds *dds, cau_dds_session *session, double now_s)
{
	cau_error error = {0};
	cau_stream_def defaults = cau_default_stream_def();
	cau_order *order = calloc(1, sizeof *order);
	session->stream.retry_s = now_s + RETRY_S;
	if (!order)
		return;
	order->kind = CAU_ORDER_JOIN;
	order->reply = cau_dds_reply(dds, CAU_METHOD_SESSION_JOIN);
	order->as.join.rate_hz = RATE_HZ;
	order->as.join.step_m = defaults.step_m;
	order->as.join.channels = defaults.channels;
	session->stream.ticket = order->reply.connection;
	if (cau_hosted_submit(session->hosted, order, &error)) {
		session->stream.ticket = 0;
		free(order);
	}
}

void cau_dds_joined(cau_dds_session *session, cau_dds_post *post)
{
	cau_dds_stream *stream = &session->stream;
	cau_error error = post->error;
	stream->ticket = 0;
	if (post->failed || cau_dds_post_result(post, &stream->description, &error)) {
		cau_log(CAU_LOG_WARNING, cau_hosted_id(session->hosted), "dds_no_stream", "reason=\"%s\"",
		        error.reason);
		return;
	}
	cau_hosted_release(post->joined); // the session holds a reference of its own
	post->joined = NULL;
	stream->joined = true;
	stream->chain = (cau_subscriber){.stream = post->stream, .key_asked_s = -INFINITY};
	stream->keys = (cau_subscriber){0};
	stream->key_wanted = stream->key_forced = false; // the chain begins with a key frame
	stream->key_epoch = stream->key_sequence = 0;
}

void cau_dds_leave_frames(cau_dds_session *session)
{
	cau_dds_stream *stream = &session->stream;
	if (!stream->joined)
		return;
	stream->joined = false;
	cau_hosted_leave(session->hosted, &stream->chain);
	// Disposes the kept samples. They would mislead a later reader, because the next stream may be
	// a different one.
	cautery_Frame key = {0};
	snprintf(key.session, sizeof key.session, "%s", cau_hosted_id(session->hosted));
	dds_dispose(stream->topology.writer, &key);
	dds_dispose(stream->key.writer, &key);
	dds_dispose(stream->delta.writer, &key);
}

double cau_dds_serve_frames(cau_dds *dds, cau_dds_session *session, double now_s)
{
	cau_dds_stream *stream = &session->stream;
	if (!has_readers(stream)) {
		cau_dds_leave_frames(session);
		return INFINITY;
	}
	if (stream->joined)
		return write_new(session, now_s);
	if (stream->ticket)
		return INFINITY;
	if (now_s >= stream->retry_s)
		join(dds, session, now_s);
	return stream->ticket ? INFINITY : stream->retry_s;
}
