// SPDX-License-Identifier: GPL-3.0-or-later
// Reads from the sockets that input.c took over, and handles the frames.
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "clock/clock.h"
#include "transport_ws/internal.h"

enum {
	READ_BYTES = 65536, // largest number of bytes in one read
};

static bool within_rate(cau_connection_input *input, int64_t most)
{
	double now_s = cau_monotonic_s();
	if (now_s - input->rate_start_s >= 1) {
		input->rate_start_s = now_s;
		input->rate_count = 0;
	}
	return ++input->rate_count <= most;
}

static void deliver(cau_connection *c, bool binary)
{
	cau_network *network = c->network;
	const cau_network_handler *handler = &network->def.handler;
	const cau_frame_reader *r = &c->input.reader;
	network->counts.messages_in++;
	network->counts.bytes_in += r->message_bytes;
	if (binary)
		handler->binary(handler->user, c, r->message, r->message_bytes);
	else
		handler->text(handler->user, c, (const char *)r->message, r->message_bytes);
}

static void handle(cau_connection *c, cau_frame_event event)
{
	const cau_frame_reader *r = &c->input.reader;
	switch (event) {
	case CAU_FRAME_TEXT:
	case CAU_FRAME_BINARY:
		deliver(c, event == CAU_FRAME_BINARY);
		break;
	case CAU_FRAME_PING:
		cau_connection_pong(c, r->control, r->control_bytes);
		break;
	case CAU_FRAME_CLOSE:
		cau_connection_closed_by_peer(c, r->close_code);
		break;
	case CAU_FRAME_BROKEN:
		cau_connection_close(c, (cau_close_code)r->close_code, r->reason);
		break;
	case CAU_FRAME_PONG:
		lws_validity_confirmed(c->wsi);
		break;
	case CAU_FRAME_FRAGMENT:
	case CAU_FRAME_MORE:
		break;
	}
}

// Handles received bytes. Returns how many were handled when the turn ended.
static size_t take(cau_connection *c, const unsigned char *bytes, size_t count, double until_s)
{
	const unsigned char *at = bytes, *end = bytes + count;
	bool in_time = true;
	c->input.heard_s = cau_monotonic_s();
	// The loop stops when the connection closes: the rest of the bytes is dropped. The socket is
	// still read, so that the peer gets to the close frame.
	while (at < end && !c->end.code && in_time) {
		cau_frame_event event = cau_frame_reader_next(&c->input.reader, &at, end);
		bool counts =
			event != CAU_FRAME_MORE && event != CAU_FRAME_CLOSE && event != CAU_FRAME_BROKEN;
		if (counts && !within_rate(&c->input, c->network->def.config->max_requests_per_s))
			cau_connection_close(c, CAU_CLOSE_RATE, NULL);
		else
			handle(c, event);
		if (counts && event != CAU_FRAME_FRAGMENT && !c->served)
			cau_strangers_bound_talk(c);
		in_time =
			event == CAU_FRAME_MORE || (cau_thread_cpu_s() < until_s && !cau_turns_blocked(c));
	}
	return c->end.code ? count : (size_t)(at - bytes);
}

static void hold(cau_connection *c, const unsigned char *bytes, size_t count)
{
	cau_connection_input *in = &c->input;
	in->held = malloc(count);
	if (!in->held) {
		cau_connection_close(c, CAU_CLOSE_FULL, "no memory for a message");
		return;
	}
	memcpy(in->held, bytes, count);
	in->held_at = 0;
	in->held_bytes = count;
}

static void take_held(cau_connection *c, double until_s)
{
	cau_connection_input *in = &c->input;
	in->held_at += take(c, in->held + in->held_at, in->held_bytes - in->held_at, until_s);
	if (in->held_at < in->held_bytes)
		return;
	free(in->held);
	in->held = NULL;
}

static bool receive(cau_connection *c, double until_s)
{
	// used by the network thread only; holds more than a TLS record
	static unsigned char bytes[READ_BYTES];
	ssize_t got = cau_connection_receive(c, bytes, sizeof bytes);
	if (got <= 0) {
		if (got == 0 || (errno != EAGAIN && errno != EINTR))
			cau_connection_ended_by_peer(c);
		return false;
	}
	c->input.sent_after_s = c->input.empty_s;
	if (got < READ_BYTES)
		c->input.empty_s = cau_monotonic_s();
	size_t taken = take(c, bytes, (size_t)got, until_s);
	if (taken < (size_t)got)
		hold(c, bytes + taken, (size_t)got - taken);
	return true;
}

bool cau_connection_read(cau_connection *c, double until_s)
{
	if (c->input.held)
		take_held(c, until_s);
	else if (!receive(c, until_s))
		return false;
	return c->input.held || cau_connection_has_more(c);
}
