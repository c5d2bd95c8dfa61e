// SPDX-License-Identifier: GPL-3.0-or-later
// What is to go out over a connection waits here until its socket can take more.
#include <string.h>

#include "transport_ws/internal.h"

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
		cau_connection_close(c, CAU_CLOSE_TOO_SLOW, "the client does not read its replies");
	lws_callback_on_writable(c->wsi);
}

void cau_connection_want_frame(cau_connection *c)
{
	lws_callback_on_writable(c->wsi);
}

void cau_connection_pong(cau_connection *c, const void *payload, size_t bytes)
{
	c->pong_due = true; // of several pings the last may be answered alone
	c->pong_bytes = bytes;
	memcpy(c->pong, payload, bytes);
	lws_callback_on_writable(c->wsi);
}
