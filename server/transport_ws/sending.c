// SPDX-License-Identifier: GPL-3.0-or-later
// The queue of outgoing bytes of a connection, which wait until the socket can take more.
#include <string.h>

#include "transport_ws/internal.h"

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
