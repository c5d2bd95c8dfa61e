// SPDX-License-Identifier: GPL-3.0-or-later
// Decides who reads a connection's socket. libwebsockets 4.1.6 accepts what RFC 6455 forbids
// (unmasked frames), reports no empty fragments, and ends a connection without a close frame if the
// protocol is broken. So after it has answered the handshake, it reads no more: flow control stops
// its reading. Our own epoll descriptor, which is in libwebsockets' loop, then reports input for
// the frame reader.
#include <sys/epoll.h>

#include "clock/clock.h"
#include "transport_ws/internal.h"

bool cau_input_open(cau_network *network)
{
	network->input = epoll_create1(EPOLL_CLOEXEC);
	if (network->input < 0)
		return false;
	lws_sock_file_fd_type descriptor = {.filefd = network->input};
	return lws_adopt_descriptor_vhost(network->vhost, LWS_ADOPT_RAW_FILE_DESC, descriptor, "input",
	                                  NULL) != NULL;
}

// ---- taking over from libwebsockets
// Takes over the reading in two steps. A client may send bytes right behind its request, although
// it must wait for the answer. libwebsockets already holds these bytes, and returns them only if it
// may read for a moment. So libwebsockets' reading is stopped while the handshake is answered. The
// first callback allows reading again: that pass of the loop handles the held bytes and reads no
// socket. The second callback stops the reading for good, before any socket is read.
bool cau_input_begin(cau_connection *c)
{
	lws_callback_on_writable(c->wsi);
	return lws_rx_flow_control(c->wsi, 0) >= 0;
}

bool cau_input_take_over(cau_connection *c)
{
	if (c->input.reading == CAU_READING_HELD) {
		c->input.reading = CAU_READING_LIBRARY;
		lws_callback_on_writable(c->wsi);
		return lws_rx_flow_control(c->wsi, 1) >= 0;
	}
	c->input.reading = CAU_READING_OURS;
	return lws_rx_flow_control(c->wsi, 0) >= 0 && cau_input_poll(c, true);
}

bool cau_input_poll(cau_connection *c, bool polled)
{
	struct epoll_event event = {.events = EPOLLIN, .data.ptr = c};
	if (polled == c->input.polled || c->input.reading != CAU_READING_OURS)
		return true;
	c->input.polled = polled;
	return epoll_ctl(c->network->input, polled ? EPOLL_CTL_ADD : EPOLL_CTL_DEL, c->descriptor,
	                 &event) == 0;
}

void cau_input_end(cau_connection *c)
{
	cau_input_poll(c, false);
	cau_input_forget(c);
	c->input.reading = CAU_READING_ENDED;
}

// ---- the list of connections with input
void cau_input_wait(cau_connection *c)
{
	if (c->turn.waits)
		return;
	c->turn.waits = true;
	c->input.empty_s = cau_monotonic_s();
	c->turn.next = c->network->waiting;
	c->network->waiting = c;
}

void cau_input_forget(cau_connection *c)
{
	if (!c->turn.waits)
		return;
	cau_connection **place = &c->network->waiting;
	while (*place != c)
		place = &(*place)->turn.next;
	*place = c->turn.next;
	c->turn.waits = false;
}
