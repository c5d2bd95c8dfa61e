// SPDX-License-Identifier: GPL-3.0-or-later
// Adds a received frame to the measurements.
#include <string.h>

#include "load/load.h"

static const double recovery_s = 2.0; // longest time until a key frame must follow a gap

static uint32_t read_u32(const unsigned char *at)
{
	return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

// Returns the bytes of the positions section of a decoded frame, or 0 if the frame has none.
static uint32_t position_bytes(const cau_client_frame *frame)
{
	const unsigned char *bytes = frame->bytes;
	size_t at = CAU_FRAME_HEADER_BYTES;
	for (int i = 0; i < frame->header.section_count; i++) {
		uint32_t payload = read_u32(bytes + at + 4);
		if (bytes[at] == CAU_SECTION_POSITIONS)
			return payload;
		at += CAU_FRAME_SECTION_BYTES + payload;
	}
	return 0;
}

static void note_gap(load_viewer *viewer, const cau_client_frame *frame)
{
	load_fleet *fleet = viewer->session->fleet;
	if (frame->status == CAU_OK && frame->header.kind != CAU_FRAME_TOPOLOGY) {
		if (viewer->gap_s > 0 && !viewer->slow && frame->decoded_s - viewer->gap_s > recovery_s)
			fleet->gaps_unrecovered++;
		viewer->gap_s = 0;
	} else if (frame->status == CAU_BAD_STATE && frame->header.kind == CAU_FRAME_DELTA &&
	           viewer->gap_s == 0 && frame->header.sequence > viewer->stream->state->sequence) {
		viewer->gap_s = frame->decoded_s;
		fleet->gaps++;
	}
}

static void note_time(load_session *session, const cau_client_frame *frame)
{
	load_mark mark = {frame->header.time_s, 1e-6 * (double)frame->header.published_us};
	if (!session->has_first)
		session->first = mark;
	session->has_first = true;
	session->last = mark;
}

void load_take_frame(void *user, cau_client *client, cau_client_stream *stream,
                     const cau_client_frame *frame)
{
	load_viewer *viewer = user;
	load_session *session = viewer->session;
	load_fleet *fleet = session->fleet;
	(void)client;
	viewer->stream = stream;
	if (frame->status != CAU_OK && frame->status != CAU_BAD_STATE)
		fleet->decode_errors++;
	note_gap(viewer, frame);
	if (frame->status || frame->header.kind == CAU_FRAME_TOPOLOGY)
		return;
	bool drives = viewer == &session->viewers[0];
	if (drives)
		load_note_command(session, frame->decoded_s);
	if (!fleet->measuring)
		return;
	fleet->frames++;
	fleet->bytes += frame->byte_count;
	if (!viewer->slow)
		load_samples_add(&fleet->frame_ms, 1e3 * (frame->decoded_s + fleet->clock.offset_s -
		                                          1e-6 * (double)frame->header.published_us));
	if (drives)
		note_time(session, frame);
	if (frame->header.kind == CAU_FRAME_DELTA && stream->state->moved_count > 0) {
		fleet->position_bytes += position_bytes(frame);
		fleet->delta_bytes += (double)frame->byte_count;
		fleet->moved += stream->state->moved_count;
	}
}
