// SPDX-License-Identifier: GPL-3.0-or-later
// How connections end. However a connection ends, the handler is notified soon. A close frame is
// sent after the queued bytes, and then our side of the socket is shut. Further bytes of the peer
// are read and dropped until the peer shuts its side. If the peer does not do so within
// CLOSE_WITHIN_S, or if more than LINGERING_MOST connections are ending, the connection is reset.
// So no socket of a closed connection stays.
#include <math.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

#include "clock/clock.h"
#include "log/log.h"
#include "transport_ws/internal.h"

// ---- the log of connections that end without hello
// Anyone can open such a connection. So each address has at most one line a minute, which counts
// the connections since the last line.

static const double line_every_s = 60;

static void write_line(cau_outsider *o, double now_s)
{
	cau_log(CAU_LOG_INFO, NULL, "ended_without_hello", "address=%s count=%llu last=\"%s\"",
	        o->owner, (unsigned long long)o->count, o->reason);
	o->count = 0;
	o->told_s = now_s;
}

// Returns the owner's entry, or a free entry. If all entries are in use, returns the first entry,
// which all owners without an entry share.
static cau_outsider *find_row(cau_network *network, const char *owner)
{
	cau_outsider *free_row = NULL;
	for (int i = CAU_OUTSIDERS_MOST - 1; i > 0; i--) {
		cau_outsider *o = &network->outsiders[i];
		if (strcmp(o->owner, owner) == 0)
			return o;
		if (!o->owner[0])
			free_row = o;
	}
	cau_outsider *row = free_row ? free_row : &network->outsiders[0];
	if (!row->owner[0])
		snprintf(row->owner, sizeof row->owner, "%s", free_row ? owner : "others");
	return row;
}

void cau_outsiders_note(cau_network *network, const char *owner, const char *reason)
{
	double now_s = cau_monotonic_s();
	cau_outsider *o = find_row(network, owner);
	bool is_due = o->told_s == 0 || now_s - o->told_s >= line_every_s;
	o->count++;
	snprintf(o->reason, sizeof o->reason, "%s", reason);
	if (is_due)
		write_line(o, now_s);
}

void cau_outsiders_tick(cau_network *network, double now_s)
{
	for (int i = 0; i < CAU_OUTSIDERS_MOST; i++) {
		cau_outsider *o = &network->outsiders[i];
		if (!o->owner[0] || now_s - o->told_s < line_every_s)
			continue;
		if (o->count)
			write_line(o, now_s);
		else
			// Nothing came within a minute, so the entry becomes free.
			*o = (cau_outsider){0};
	}
}

enum {
	CLOSE_WITHIN_S = 2, // enough for a round trip around the world and a busy peer
	LINGERING_MOST = 64,
	UNPLACED_S = 1, // time for hello of a client that may only resume, see cau_connection_has_place
	MUTED_S = 1, // delay of the answer to a wrong token, so the least time between two guesses, s
	UNHEARD_PINGS = 3,
	CLOSE_FRAME = 0x88,
	CODE_BYTES = 2,
};

// ---- lists: the handler sees open connections, but not ending ones
void cau_connection_link(cau_connection **first, cau_connection *c)
{
	c->previous = NULL;
	c->next = *first;
	if (c->next)
		c->next->previous = c;
	*first = c;
}

void cau_connection_unlink(cau_connection **first, cau_connection *c)
{
	if (c->previous)
		c->previous->next = c->next;
	else
		*first = c->next;
	if (c->next)
		c->next->previous = c->previous;
}

// Resets the connection in the next service loop. Nothing more is delivered, and no bytes stay in
// the kernel.
static void reset(cau_connection *c)
{
	c->end.resetting = true;
	struct linger at_once = {.l_onoff = 1, .l_linger = 0};
	setsockopt(c->descriptor, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
	lws_set_timeout(c->wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
}

static void bound_lingering(cau_network *network)
{
	cau_connection *oldest = NULL;
	int count = 0;
	for (cau_connection *c = network->lingering; c; c = c->next) {
		// The list has the newest connection first.
		oldest = c->end.resetting ? oldest : c;
		count += !c->end.resetting;
	}
	if (count > LINGERING_MOST)
		reset(oldest);
}

void cau_connection_leave(cau_connection *c)
{
	cau_network *network = c->network;
	if (c->end.left)
		return;
	c->end.left = true;
	network->def.handler.closed(network->def.handler.user, c);
	cau_connection_unlink(&network->connections, c);
	cau_connection_link(&network->lingering, c);
	network->counts.connections--;
	network->counts.served -= c->served;
	bound_lingering(network);
}

// ---- reasons
// Begins to close the connection. The timer notifies the handler a moment later, because the
// handler may be working with this connection now.
static void begin_closing(cau_connection *c, int code, const char *reason)
{
	c->end.code = code;
	snprintf(c->end.reason, sizeof c->end.reason, "%s", reason);
	if (c->served)
		cau_log(CAU_LOG_INFO, NULL, "connection_closing", "connection=%llu code=%d reason=\"%s\"",
		        (unsigned long long)c->id, c->end.code, c->end.reason);
	else
		cau_outsiders_note(c->network, c->owner, c->end.reason);
	lws_set_timer_usecs(c->wsi, 1);
	lws_callback_on_writable(c->wsi);
}

void cau_connection_close(cau_connection *c, cau_close_code code, const char *reason)
{
	if (c->end.code)
		return;
	if (code == CAU_CLOSE_TOO_SLOW)
		c->network->counts.closed_slow++;
	else if (code != CAU_CLOSE_DONE && code != CAU_CLOSE_DRAINING)
		c->network->counts.closed_errors++;
	begin_closing(c, (int)code, reason ? reason : cau_close_reason(code));
}

void cau_connection_close_late(cau_connection *c, cau_close_code code)
{
	c->end.muted = !c->end.code;
	cau_connection_close(c, code, NULL);
}

void cau_connection_closed_by_peer(cau_connection *c, int code)
{
	c->end.peer_ended = true; // a peer sends nothing after its close frame
	if (!c->end.code)
		begin_closing(c, code ? code : CAU_CLOSE_DONE, "");
}

void cau_connection_ended_by_peer(cau_connection *c)
{
	c->end.peer_ended = true;
	// Otherwise epoll would report the end again and again.
	cau_input_end(c);
	if (!c->end.code)
		begin_closing(c, CAU_CLOSE_DONE, "");
	lws_callback_on_writable(c->wsi);
}

void cau_connection_timer(cau_connection *c)
{
	if (c->end.muted && c->end.left) {
		c->end.muted = false;
		lws_callback_on_writable(c->wsi);
		lws_set_timer_usecs(c->wsi, CLOSE_WITHIN_S * LWS_US_PER_SEC);
	} else if (c->end.code && c->end.left) {
		reset(c);
	} else if (c->end.code) {
		cau_connection_leave(c);
		lws_set_timer_usecs(c->wsi, (c->end.muted ? MUTED_S : CLOSE_WITHIN_S) * LWS_US_PER_SEC);
	}
}

// ---- the close frame
static size_t write_close_frame(const cau_connection_end *end, unsigned char *at)
{
	size_t reason_bytes = strlen(end->reason);
	at[0] = CLOSE_FRAME;
	at[1] = (unsigned char)(CODE_BYTES + reason_bytes);
	at[2] = (unsigned char)(end->code >> 8);
	at[3] = (unsigned char)(end->code & 255);
	memcpy(at + 4, end->reason, reason_bytes);
	return 4 + reason_bytes;
}

// Writes the close frame, then shuts the socket; libwebsockets calls it again once the frame is in
// the kernel. libwebsockets' own close would close the socket right behind the frame. With input
// unread, the kernel would then reset the connection before the peer has seen the code.
int cau_connection_write_close(cau_connection *c)
{
	unsigned char frame[LWS_PRE + CAU_CLOSE_FRAME_BYTES];
	if (c->end.close_sent) {
		cau_connection_shut(c);
		return c->end.peer_ended ? -1 : 0;
	}
	c->end.close_sent = true;
	size_t bytes = write_close_frame(&c->end, frame + LWS_PRE);
	lws_callback_on_writable(c->wsi);
	return lws_write(c->wsi, frame + LWS_PRE, bytes, LWS_WRITE_RAW) < 0 ? -1 : 0;
}

// Called when libwebsockets ends a connection that it still reads itself: bytes behind the request
// broke the protocol. The close frame is so short that the socket takes it at once.
void cau_connection_dropped(cau_connection *c)
{
	unsigned char frame[CAU_CLOSE_FRAME_BYTES];
	if (c->input.reading >= CAU_READING_OURS || c->end.close_sent)
		return;
	cau_connection_close(c, CAU_CLOSE_PROTOCOL, "data before the handshake was answered");
	c->end.close_sent = true;
	size_t bytes = write_close_frame(&c->end, frame);
	cau_connection_put(c, frame, bytes);
}

// Closes a connection whose hello is late. The connection has no timer of its own for this, because
// libwebsockets searches its sorted list of timers from the start.
static void watch_hello(cau_connection *c, double now_s)
{
	double within_s = c->network->def.config->hello_timeout_s, age_s = now_s - c->opened_s;
	if (c->unplaced && age_s > fmin(within_s, UNPLACED_S))
		cau_connection_close(c, CAU_CLOSE_FULL, CAU_NO_PLACE);
	else if (age_s > within_s)
		cau_connection_close(c, CAU_CLOSE_NO_HELLO, NULL);
}

void cau_connection_watch(cau_connection *c, double now_s)
{
	if (!c->served)
		watch_hello(c, now_s);
	// A connection whose messages wait for a turn counts as heard.
	if (c->turn.waits && !cau_turns_blocked(c))
		c->input.heard_s = now_s;
	if (now_s - c->input.heard_s > UNHEARD_PINGS * c->network->def.config->ping_s)
		cau_connection_close(c, CAU_CLOSE_NO_ANSWER, NULL);
}

// ---- outgoing bytes, which wait until the socket can take more
static void queue(cau_connection_output *output, cau_buffer *reply)
{
	reply->next = NULL;
	if (output->last)
		output->last->next = reply;
	else
		output->first = reply;
	output->last = reply;
	output->bytes += reply->byte_count;
}

void cau_connection_send(cau_connection *c, cau_buffer *buffer)
{
	if (!buffer || c->end.code) {
		cau_buffer_release(buffer);
		return;
	}
	queue(&c->output, buffer);
	if (c->output.bytes > CAU_CONTROL_BYTES_MAX)
		cau_connection_close(c, CAU_CLOSE_TOO_SLOW, "the client does not read its replies");
	lws_callback_on_writable(c->wsi);
}

void cau_connection_want_frame(cau_connection *c)
{
	lws_callback_on_writable(c->wsi);
}

void cau_connection_pong(cau_connection *c, const void *payload, size_t bytes)
{
	c->output.pong_due = true; // if several pings came, it is enough to answer the last ping
	c->output.pong_bytes = bytes;
	memcpy(c->output.pong, payload, bytes);
	lws_callback_on_writable(c->wsi);
}
