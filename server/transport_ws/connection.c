// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_ws/connection.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>

#include "clock/clock.h"
#include "log/log.h"
#include "transport_ws/internal.h"

enum { CLOSE_WITHIN_S = 5 };

void cau_connection_send(cau_connection *c, cau_buffer *buffer)
{
	if (!buffer || c->closing) {
		cau_buffer_release(buffer);
		return;
	}
	buffer->next = NULL;
	if (c->control_last)
		c->control_last->next = buffer;
	else
		c->control_first = buffer;
	c->control_last = buffer;
	c->control_bytes += buffer->byte_count;
	if (c->control_bytes > CAU_CONTROL_BYTES_MAX)
		cau_connection_close(c, CAU_CLOSE_TOO_SLOW, "replies are not being read");
	lws_callback_on_writable(c->wsi);
}

void cau_connection_want_frame(cau_connection *c)
{
	lws_callback_on_writable(c->wsi);
}

void cau_connection_close(cau_connection *c, cau_close_code code, const char *reason)
{
	if (c->closing)
		return;
	c->closing = (int)code;
	snprintf(c->closing_reason, sizeof c->closing_reason, "%s",
	         reason ? reason : cau_close_reason(code));
	if (code == CAU_CLOSE_TOO_SLOW)
		c->network->counts.closed_slow++;
	else if (code != CAU_CLOSE_DONE && code != CAU_CLOSE_DRAINING)
		c->network->counts.closed_errors++;
	cau_log(CAU_LOG_INFO, NULL, "connection_closing", "connection=%llu code=%d reason=\"%s\"",
	        (unsigned long long)c->id, c->closing, c->closing_reason);
	lws_set_timeout(c->wsi, PENDING_TIMEOUT_USER_REASON_BASE, CLOSE_WITHIN_S);
	lws_callback_on_writable(c->wsi);
}

// A slow reader must see fresh data: without the low-water mark the kernel takes seconds of frames
// ahead of it, and pings queue behind them.
static void set_socket(int descriptor)
{
	int low = NOTSENT_LOWAT_BYTES, on = 1;
	setsockopt(descriptor, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &low, sizeof low);
	setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

static void link_in(cau_network *network, cau_connection *c)
{
	c->next = network->connections;
	if (c->next)
		c->next->previous = c;
	network->connections = c;
	network->counts.connections++;
	network->counts.accepted++;
}

static int opened(cau_network *network, struct lws *wsi, cau_connection **slot)
{
	char session[HEADER_BYTES];
	cau_connection *c = calloc(1, sizeof *c);
	if (!c)
		return -1;
	c->id = ++network->last_id;
	c->network = network;
	c->wsi = wsi;
	c->descriptor = lws_get_socket_fd(wsi);
	c->opened_s = c->last_taken_s = c->rate_start_s = cau_monotonic_s();
	set_socket(c->descriptor);
	lws_get_peer_simple(wsi, c->address, sizeof c->address);
	link_in(network, c);
	*slot = c;
	const char *asked = lws_get_urlarg_by_name(wsi, "session=", session, sizeof session);
	lws_set_timer_usecs(wsi, (lws_usec_t)(network->def.config->hello_timeout_s * 1e6));
	if (!cau_first_frame_watch(c) ||
	    !network->def.handler.opened(network->def.handler.user, c, asked ? asked : ""))
		return -1;
	return 0;
}

static void closed(cau_network *network, cau_connection *c)
{
	cau_first_frame_forget(c);
	network->def.handler.closed(network->def.handler.user, c);
	if (c->previous)
		c->previous->next = c->next;
	else
		network->connections = c->next;
	if (c->next)
		c->next->previous = c->previous;
	network->counts.connections--;
	for (cau_buffer *b = c->control_first, *next; b; b = next) {
		next = b->next;
		cau_buffer_release(b);
	}
	free(c->message);
	free(c);
}

static bool grow_message(cau_connection *c, size_t wanted)
{
	size_t capacity = c->message_capacity ? c->message_capacity : 4096;
	while (capacity < wanted)
		capacity *= 2;
	if (capacity == c->message_capacity)
		return true;
	unsigned char *grown = realloc(c->message, capacity);
	if (!grown)
		return false;
	c->message = grown;
	c->message_capacity = capacity;
	return true;
}

static bool within_rate(cau_connection *c)
{
	double now_s = cau_monotonic_s();
	if (now_s - c->rate_start_s >= 1) {
		c->rate_start_s = now_s;
		c->rate_count = 0;
	}
	return ++c->rate_count <= c->network->def.config->max_requests_per_s;
}

static void deliver(cau_network *network, cau_connection *c, bool binary)
{
	const cau_network_handler *handler = &network->def.handler;
	network->counts.messages_in++;
	network->counts.bytes_in += c->message_bytes;
	if (!within_rate(c))
		cau_connection_close(c, CAU_CLOSE_RATE, NULL);
	else if (binary)
		handler->binary(handler->user, c, c->message, c->message_bytes);
	else
		handler->text(handler->user, c, (const char *)c->message, c->message_bytes);
	c->message_bytes = 0;
	if (c->message_capacity > 65536) { // a big one was the exception
		free(c->message);
		c->message = NULL;
		c->message_capacity = 0;
	}
}

static void receive(cau_network *network, cau_connection *c, const void *in, size_t bytes)
{
	if (c->closing)
		return;
	if (!c->first_frame_seen) {
		cau_connection_close(c, CAU_CLOSE_PROTOCOL, "data before the handshake was answered");
		return;
	}
	size_t wanted = c->message_bytes + bytes + lws_remaining_packet_payload(c->wsi);
	if (wanted > (size_t)network->def.config->max_message_bytes) {
		cau_connection_close(c, CAU_CLOSE_TOO_BIG, "the message is larger than max_message_bytes");
		return;
	}
	if (!grow_message(c, c->message_bytes + bytes + 1)) {
		cau_connection_close(c, CAU_CLOSE_INTERNAL, "memory ran out");
		return;
	}
	if (bytes)
		memcpy(c->message + c->message_bytes, in, bytes);
	c->message_bytes += bytes;
	c->message[c->message_bytes] = 0;
	if (lws_is_final_fragment(c->wsi) && lws_remaining_packet_payload(c->wsi) == 0)
		deliver(network, c, lws_frame_is_binary(c->wsi));
}

static int write_buffer(cau_network *network, cau_connection *c, cau_buffer *buffer)
{
	int written = lws_write(c->wsi, cau_buffer_bytes(buffer), buffer->byte_count,
	                        buffer->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT);
	network->counts.messages_out++;
	network->counts.frames_out += buffer->binary;
	network->counts.bytes_out += buffer->byte_count;
	c->last_taken_s = cau_monotonic_s();
	return written < (int)buffer->byte_count ? -1 : 0;
}

// libwebsockets would close the socket right behind its close frame; with input unread the kernel
// then resets the connection, and the peer never sees the code. So the frame goes out by hand.
static int send_close(cau_connection *c)
{
	enum { FINAL_CLOSE = 0x88, HEAD_BYTES = 4 };
	unsigned char frame[LWS_PRE + HEAD_BYTES + CAU_CLOSE_REASON_BYTES];
	size_t reason_bytes = strlen(c->closing_reason);
	if (c->close_sent)
		return 0;
	c->close_sent = true;
	unsigned char *at = frame + LWS_PRE;
	at[0] = FINAL_CLOSE;
	at[1] = (unsigned char)(2 + reason_bytes);
	at[2] = (unsigned char)(c->closing >> 8);
	at[3] = (unsigned char)(c->closing & 255);
	memcpy(at + HEAD_BYTES, c->closing_reason, reason_bytes);
	return lws_write(c->wsi, at, HEAD_BYTES + reason_bytes, LWS_WRITE_RAW) < 0 ? -1 : 0;
}

static cau_buffer *take_control(cau_connection *c)
{
	cau_buffer *buffer = c->control_first;
	if (!buffer)
		return NULL;
	c->control_first = buffer->next;
	if (!c->control_first)
		c->control_last = NULL;
	c->control_bytes -= buffer->byte_count;
	return buffer;
}

// Replies go first: many viewers must not hold up commands.
static int writable(cau_network *network, cau_connection *c)
{
	cau_buffer *buffer = take_control(c);
	if (!buffer && c->closing)
		return send_close(c);
	if (!buffer)
		buffer = network->def.handler.next_frame(network->def.handler.user, c);
	if (!buffer)
		return 0;
	int failed = write_buffer(network, c, buffer);
	cau_buffer_release(buffer);
	if (!failed)
		lws_callback_on_writable(c->wsi);
	return failed;
}

static void timer(cau_connection *c)
{
	if (!c->served)
		cau_connection_close(c, CAU_CLOSE_NO_HELLO, NULL);
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
	case LWS_CALLBACK_RECEIVE:
		receive(network, *slot, in, bytes);
		return 0;
	case LWS_CALLBACK_SERVER_WRITEABLE:
		return writable(network, *slot);
	case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
		return (*slot)->close_sent ? -1 : 0;
	case LWS_CALLBACK_TIMER:
		timer(*slot);
		return 0;
	case LWS_CALLBACK_CLOSED:
		if (slot && *slot)
			closed(network, *slot);
		return 0;
	default:
		return 0;
	}
}
