// SPDX-License-Identifier: GPL-3.0-or-later
// The libwebsockets callbacks of one connection: its beginning, its writes, its end. closing.c
// queues bytes to write and ends the connection, reading.c reads.
#include "transport_ws/connection.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>

#include "clock/clock.h"
#include "transport_ws/internal.h"

enum { PONG_FRAME = 0x8A };

// ---- beginning and end
// Limits unsent bytes in the kernel, so that a slow reader gets fresh data. Without the low-water
// mark the kernel takes seconds of frames in advance, and pings wait behind them.
static void set_socket(int descriptor)
{
	int low = NOTSENT_LOWAT_BYTES, on = 1;
	setsockopt(descriptor, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &low, sizeof low);
	setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

static cau_connection *make(cau_network *network, struct lws *wsi)
{
	cau_connection *c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	c->id = ++network->last_id;
	c->network = network;
	c->wsi = wsi;
	c->descriptor = lws_get_socket_fd(wsi);
	c->opened_s = c->input.rate_start_s = c->input.heard_s = cau_monotonic_s();
	cau_frame_reader_init(&c->input.reader, (size_t)network->def.config->max_message_bytes);
	lws_get_peer_simple(wsi, c->address, sizeof c->address);
	char forwarded[HEADER_BYTES];
	bool told = cau_request_header(wsi, WSI_TOKEN_X_FORWARDED_FOR, forwarded, sizeof forwarded);
	cau_auth_find_address(network->def.config, told ? forwarded : NULL, c->address,
	                      sizeof c->address);
	cau_address_owner(c->address, c->owner);
	if (!cau_share_open(&network->shares, &c->turn.share, c->owner, CAU_STANDING_UNKNOWN,
	                    c->opened_s)) {
		free(c);
		return NULL;
	}
	return c;
}

static int opened(cau_network *network, struct lws *wsi, cau_connection **slot)
{
	char session[HEADER_BYTES];
	cau_connection *c = make(network, wsi);
	if (!c)
		return -1;
	*slot = c;
	set_socket(c->descriptor);
	cau_connection_link(&network->connections, c);
	network->counts.connections++;
	network->counts.accepted++;
	const char *asked = lws_get_urlarg_by_name(wsi, "session=", session, sizeof session);
	c->unplaced = !cau_connection_has_place(c, false);
	if (!cau_input_begin(c) ||
	    !network->def.handler.opened(network->def.handler.user, c, asked ? asked : ""))
		return -1;
	cau_strangers_bound_silent(network, c);
	return 0;
}

static void closed(cau_network *network, cau_connection *c)
{
	cau_input_end(c);
	cau_connection_leave(c);
	cau_connection_unlink(&network->lingering, c);
	for (cau_buffer *b = c->output.first, *next; b; b = next) {
		next = b->next;
		cau_buffer_release(b);
	}
	cau_frame_reader_finish(&c->input.reader);
	cau_share_close(&c->turn.share);
	free(c->input.held);
	free(c);
}

// ---- writing
static int write_buffer(cau_network *network, cau_connection *c, cau_buffer *buffer)
{
	int written = lws_write(c->wsi, cau_buffer_bytes(buffer), buffer->byte_count,
	                        buffer->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT);
	network->counts.messages_out++;
	network->counts.frames_out += buffer->binary;
	network->counts.bytes_out += buffer->byte_count;
	return written < (int)buffer->byte_count ? -1 : 0;
}

static int write_pong(cau_connection *c)
{
	cau_connection_output *out = &c->output;
	unsigned char frame[LWS_PRE + 2 + CAU_CONTROL_FRAME_BYTES];
	out->pong_due = false;
	frame[LWS_PRE] = PONG_FRAME;
	frame[LWS_PRE + 1] = (unsigned char)out->pong_bytes;
	memcpy(frame + LWS_PRE + 2, out->pong, out->pong_bytes);
	lws_callback_on_writable(c->wsi);
	return lws_write(c->wsi, frame + LWS_PRE, 2 + out->pong_bytes, LWS_WRITE_RAW) < 0 ? -1 : 0;
}

static cau_buffer *take_reply(cau_connection_output *output)
{
	cau_buffer *buffer = output->first;
	if (!buffer)
		return NULL;
	output->first = buffer->next;
	if (!output->first)
		output->last = NULL;
	output->bytes -= buffer->byte_count;
	return buffer;
}

static bool take_over(cau_connection *c)
{
	if (!cau_input_take_over(c))
		return false;
	// These bytes are the rest of a TLS record that began with the request.
	if (c->input.reading == CAU_READING_OURS && cau_connection_has_more(c))
		cau_connection_close(c, CAU_CLOSE_PROTOCOL, "data before the handshake was answered");
	return true;
}

// Writes one reply or frame. Replies go first, because many viewers must not hold up commands.
static int writable(cau_network *network, cau_connection *c)
{
	if (c->input.reading < CAU_READING_OURS && !take_over(c))
		return -1;
	if (c->end.muted)
		return 0;
	if (c->output.pong_due && !c->end.close_sent)
		return write_pong(c);
	double began_s = cau_thread_cpu_s();
	cau_buffer *buffer = take_reply(&c->output);
	bool reply = buffer;
	if (!buffer && c->end.code)
		return cau_connection_write_close(c);
	if (!buffer)
		buffer = network->def.handler.next_frame(network->def.handler.user, c);
	if (!buffer)
		return 0;
	int failed = write_buffer(network, c, buffer);
	if (reply) {
		cau_share_charge(&c->turn.share, cau_thread_cpu_s() - began_s, cau_monotonic_s());
		cau_turns_resume(c);
	}
	cau_buffer_release(buffer);
	if (!failed)
		lws_callback_on_writable(c->wsi);
	return failed;
}

int cau_ws_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t bytes)
{
	cau_connection **slot = user;
	cau_network *network = cau_network_of(wsi);
	switch (reason) {
	case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
	case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
		return cau_http_callback(wsi, reason, NULL, in, bytes);
	case LWS_CALLBACK_ESTABLISHED:
		return opened(network, wsi, slot);
	case LWS_CALLBACK_RECEIVE: // see cau_input_begin
		cau_connection_close(*slot, CAU_CLOSE_PROTOCOL, "data before the handshake was answered");
		return 0;
	case LWS_CALLBACK_SERVER_WRITEABLE:
		return writable(network, *slot);
	case LWS_CALLBACK_TIMER:
		cau_connection_timer(*slot);
		return 0;
	case LWS_CALLBACK_WS_SERVER_DROP_PROTOCOL:
		if (slot && *slot)
			cau_connection_dropped(*slot);
		return 0;
	case LWS_CALLBACK_CLOSED:
		if (slot && *slot)
			closed(network, *slot);
		return 0;
	default:
		return 0;
	}
}
