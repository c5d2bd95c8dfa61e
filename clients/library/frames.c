// SPDX-License-Identifier: Apache-2.0
// Decodes frames to the newest state, asks for key frames after gaps, and acknowledges frames.
#include <stdlib.h>

#include "library/internal.h"

// Wait from a gap to the request for a key frame, s. The server sends a key frame without a request
// if it knows of the gap.
static const double patience_s = 0.25;
// Wait from one request for a key frame to the next, s. The server sends at most one requested key
// frame a second.
static const double ask_again_s = 1.0;

static cau_client_slot *find_slot(cau_client *client, const cau_frame_header *header)
{
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++) {
		cau_client_slot *slot = client->slots[i];
		if (slot && slot->decoder && !slot->stream.ended &&
		    slot->stream.def.session == header->session)
			return slot;
	}
	return NULL;
}

static cau_status take_topology(cau_client_slot *slot, const void *bytes, size_t byte_count,
                                cau_error *error)
{
	void *scratch = malloc(cau_topology_scratch_bytes(&slot->stream.def));
	if (!scratch)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the topology");
	cau_status status = cau_topology_decode(&slot->stream.def, bytes, byte_count, scratch,
	                                        &slot->stream.topology, error);
	free(scratch);
	slot->stream.has_topology = !status;
	return status;
}

// True if a delta is missing before this frame. A delta older than the present state, or an
// unneeded key frame, is not a gap.
static bool is_gap(const cau_client_slot *slot, const cau_frame_header *header)
{
	const cau_stream_state *state = slot->stream.state;
	return header->kind == CAU_FRAME_DELTA && header->profile == slot->stream.def.profile &&
	       (!state->synced || header->epoch != state->epoch || header->sequence > state->sequence);
}

static void count(cau_client_slot *slot, const cau_client_frame *frame)
{
	cau_client_stream *stream = &slot->stream;
	stream->bytes += frame->byte_count;
	switch (frame->status) {
	case CAU_OK:
		stream->frames++;
		stream->key_frames += frame->header.kind == CAU_FRAME_KEY;
		stream->received_s = frame->received_s;
		if (frame->header.kind != CAU_FRAME_TOPOLOGY)
			slot->gap_s = 0;
		return;
	case CAU_BAD_STATE:
		stream->skipped++;
		if (slot->gap_s == 0 && is_gap(slot, &frame->header)) {
			stream->gaps++;
			slot->gap_s = frame->received_s;
		}
		return;
	default:
		stream->damaged++;
		if (slot->gap_s == 0)
			slot->gap_s = frame->received_s;
	}
}

void cau_frame_received(cau_client *client, const void *bytes, size_t byte_count)
{
	cau_client_frame frame = {
		.bytes = bytes, .byte_count = byte_count, .received_s = cau_client_now()};
	cau_client_slot *slot = NULL;
	frame.status = cau_frame_header_read(bytes, byte_count, &frame.header, NULL);
	if (!frame.status)
		slot = find_slot(client, &frame.header);
	// The frame is of a session just left, or its header is invalid, so it belongs to no stream.
	if (!slot)
		return;
	if (frame.header.kind == CAU_FRAME_TOPOLOGY)
		frame.status = take_topology(slot, bytes, byte_count, NULL);
	else
		frame.status = cau_frame_decode(slot->decoder, bytes, byte_count, NULL);
	frame.decoded_s = cau_client_now();
	count(slot, &frame);
	if (client->def.on_frame)
		client->def.on_frame(client->def.user, client, &slot->stream, &frame);
}

static void acknowledge(cau_client_slot *slot)
{
	const cau_stream_state *state = slot->stream.state;
	cau_wire_stream_ack ack = {
		.has_session = true, .epoch = state->epoch, .sequence = (int64_t)state->sequence};
	if (!state->synced || state->sequence == slot->acknowledged)
		return;
	snprintf(ack.session, sizeof ack.session, "%s", slot->stream.description.session);
	if (!cau_client_notify(slot->client, CAU_METHOD_STREAM_ACK, &ack, NULL))
		slot->acknowledged = state->sequence;
}

static void ask_for_key_frame(cau_client_slot *slot, double now_s)
{
	cau_wire_session_ref params = {.has_session = true};
	if (slot->gap_s == 0 || now_s - slot->gap_s < patience_s ||
	    now_s - slot->key_asked_s < ask_again_s)
		return;
	snprintf(params.session, sizeof params.session, "%s", slot->stream.description.session);
	slot->key_asked_s = now_s;
	cau_client_send(slot->client, CAU_METHOD_STREAM_KEY_FRAME, &params, NULL, NULL, NULL);
}

void cau_streams_tick(cau_client *client)
{
	double now_s = cau_client_now();
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++) {
		cau_client_slot *slot = client->slots[i];
		if (!slot || !slot->decoder || slot->stream.ended)
			continue;
		acknowledge(slot);
		ask_for_key_frame(slot, now_s);
	}
}

int64_t cau_client_faces_drawn(const cau_client_stream *stream)
{
	int64_t drawn = stream->state->face_mask ? stream->def.face_count : 0;
	for (int32_t i = 0; stream->state->face_mask && i < (stream->def.face_count + 31) / 32; i++)
		drawn -= __builtin_popcount(stream->state->face_mask[i]);
	return drawn;
}
