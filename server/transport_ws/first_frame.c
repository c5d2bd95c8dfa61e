// SPDX-License-Identifier: GPL-3.0-or-later
// libwebsockets reads unmasked client frames without complaint, which RFC 6455 (5.1) forbids.
// Reading is held back on a new connection; this room's own epoll, itself a descriptor in
// libwebsockets' loop, says when the first two bytes are there, and they are looked at without
// being taken.
#include <errno.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "transport_ws/internal.h"

enum { MASK_BIT = 0x80, EVENTS_AT_ONCE = 32, FIRST_BYTES = 2 };

bool cau_first_frame_open(cau_network *network)
{
	network->first_frames = epoll_create1(EPOLL_CLOEXEC);
	if (network->first_frames < 0)
		return false;
	lws_sock_file_fd_type descriptor = {.filefd = network->first_frames};
	return lws_adopt_descriptor_vhost(network->vhost, LWS_ADOPT_RAW_FILE_DESC, descriptor,
	                                  "first-frame", NULL) != NULL;
}

bool cau_first_frame_watch(cau_connection *connection)
{
	int low = FIRST_BYTES;
	struct epoll_event event = {.events = EPOLLIN, .data.u64 = connection->id};
	setsockopt(connection->descriptor, SOL_SOCKET, SO_RCVLOWAT, &low, sizeof low);
	return lws_rx_flow_control(connection->wsi, 0) >= 0 &&
	       epoll_ctl(connection->network->first_frames, EPOLL_CTL_ADD, connection->descriptor,
	                 &event) == 0;
}

void cau_first_frame_forget(cau_connection *connection)
{
	if (connection->first_frame_seen)
		return;
	connection->first_frame_seen = true;
	epoll_ctl(connection->network->first_frames, EPOLL_CTL_DEL, connection->descriptor, NULL);
}

static void look(cau_connection *connection)
{
	unsigned char start[FIRST_BYTES];
	ssize_t got = recv(connection->descriptor, start, sizeof start, MSG_PEEK | MSG_DONTWAIT);
	if (got < 0 && (errno == EAGAIN || errno == EINTR))
		return;
	int low = 1;
	setsockopt(connection->descriptor, SOL_SOCKET, SO_RCVLOWAT, &low, sizeof low);
	cau_first_frame_forget(connection);
	if (got == FIRST_BYTES && !(start[1] & MASK_BIT))
		cau_connection_close(connection, CAU_CLOSE_PROTOCOL, "client frames must be masked");
	lws_rx_flow_control(connection->wsi, 1);
}

int cau_first_frame_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user,
                             void *in, size_t bytes)
{
	(void)user, (void)in, (void)bytes;
	if (reason != LWS_CALLBACK_RAW_RX_FILE)
		return 0;
	cau_network *network = cau_network_of(wsi);
	struct epoll_event events[EVENTS_AT_ONCE];
	int count = epoll_wait(network->first_frames, events, EVENTS_AT_ONCE, 0);
	for (int i = 0; i < count; i++) {
		cau_connection *connection = cau_network_find(network, events[i].data.u64);
		if (connection)
			look(connection);
	}
	return 0;
}
