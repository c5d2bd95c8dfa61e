// SPDX-License-Identifier: GPL-3.0-or-later
// What comes in over the sockets that input.c took over: frames, and what they lead to.
#include <errno.h>
#include <sys/epoll.h>

#include "clock/clock.h"
#include "transport_ws/internal.h"

enum {
	EVENTS_AT_ONCE = 32,
	READ_BYTES = 65536, // of one connection at a time: the others have their turn
	                    // in between
};

static bool within_rate(cau_connection *c)
{
	double now_s = cau_monotonic_s();
	if (now_s - c->rate_start_s >= 1) {
		c->rate_start_s = now_s;
		c->rate_count = 0;
	}
	return ++c->rate_count <= c->network->def.config->max_requests_per_s;
}

static void deliver(cau_connection *c, bool binary)
{
	cau_network *network = c->network;
	const cau_network_handler *handler = &network->def.handler;
	const cau_frame_reader *r = &c->reader;
	network->counts.messages_in++;
	network->counts.bytes_in += r->message_bytes;
	if (binary)
		handler->binary(handler->user, c, r->message, r->message_bytes);
	else
		handler->text(handler->user, c, (const char *)r->message, r->message_bytes);
}

static void handle(cau_connection *c, cau_frame_event event)
{
	switch (event) {
	case CAU_FRAME_TEXT:
	case CAU_FRAME_BINARY:
		deliver(c, event == CAU_FRAME_BINARY);
		break;
	case CAU_FRAME_PING:
		cau_connection_pong(c, c->reader.control, c->reader.control_bytes);
		break;
	case CAU_FRAME_CLOSE:
		cau_connection_closed_by_peer(c, c->reader.close_code);
		break;
	case CAU_FRAME_BROKEN:
		cau_connection_close(c, (cau_close_code)c->reader.close_code, c->reader.reason);
		break;
	case CAU_FRAME_PONG:
		lws_validity_confirmed(c->wsi);
		break;
	case CAU_FRAME_FRAGMENT:
	case CAU_FRAME_MORE:
		break;
	}
}

static void take(cau_connection *c, const unsigned char *bytes, size_t count)
{
	const unsigned char *at = bytes, *end = bytes + count;
	c->heard_s = cau_monotonic_s();
	// A connection that is being closed is read on, so that its peer gets to the
	// close frame, but nothing is done for it.
	while (at < end && !c->closing) {
		cau_frame_event event = cau_frame_reader_next(&c->reader, &at, end);
		bool counts =
			event != CAU_FRAME_MORE && event != CAU_FRAME_CLOSE && event != CAU_FRAME_BROKEN;
		if (counts && !within_rate(c))
			cau_connection_close(c, CAU_CLOSE_RATE, NULL);
		else
			handle(c, event);
	}
}

static void read_some(cau_connection *c)
{
	static unsigned char bytes[READ_BYTES]; // the network thread's alone, more than a record of TLS
	ssize_t got;
	do {
		got = cau_connection_receive(c, bytes, sizeof bytes);
		if (got > 0)
			take(c, bytes, (size_t)got);
		else if (got == 0 || (errno != EAGAIN && errno != EINTR))
			cau_connection_ended_by_peer(c);
	} while (got > 0 && cau_connection_has_more(c));
}

// No connection is freed in here: ends are asked for, and made by
// libwebsockets' loop.
int cau_input_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t bytes)
{
	(void)user, (void)in, (void)bytes;
	if (reason != LWS_CALLBACK_RAW_RX_FILE)
		return 0;
	cau_network_comes_round(cau_network_of(wsi));
	struct epoll_event events[EVENTS_AT_ONCE];
	int count = epoll_wait(cau_network_of(wsi)->input, events, EVENTS_AT_ONCE, 0);
	for (int i = 0; i < count; i++)
		read_some(events[i].data.ptr);
	return 0;
}
