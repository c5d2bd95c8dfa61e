// SPDX-License-Identifier: Apache-2.0
// Handles the events of libwebsockets: assembles received messages, writes queued ones, and reports
// how a connection ended. It also creates the event loop, because libwebsockets needs this event
// handler at that time.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "library/internal.h"

enum { RECEIVE_BYTES = 65536 };

static int write_one(cau_client *client)
{
	cau_outbox_message *message = cau_outbox_take(&client->outbox);
	if (!message) {
		if (!client->closing)
			return 0;
		lws_close_reason(client->wsi, LWS_CLOSE_STATUS_NORMAL, NULL, 0);
		return -1;
	}
	int written = lws_write(client->wsi, cau_outbox_bytes(message), message->byte_count,
	                        message->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT);
	bool short_write = written < (int)message->byte_count;
	free(message);
	if (short_write)
		return -1;
	if (client->outbox.first || client->closing)
		lws_callback_on_writable(client->wsi);
	return 0;
}

static bool append(cau_client *client, const void *in, size_t bytes)
{
	size_t wanted = client->message.byte_count + bytes;
	size_t most = lws_frame_is_binary(client->wsi) ? (size_t)CAU_CLIENT_BINARY_MAX
	                                               : (size_t)CAU_CLIENT_TEXT_MAX;
	if (wanted > most)
		return false;
	if (wanted > client->message.capacity) {
		size_t capacity = client->message.capacity ? client->message.capacity : 8192;
		while (capacity < wanted)
			capacity *= 2;
		void *grown = realloc(client->message.bytes, capacity);
		if (!grown)
			return false;
		client->message.bytes = grown;
		client->message.capacity = capacity;
	}
	if (bytes)
		memcpy(client->message.bytes + client->message.byte_count, in, bytes);
	client->message.byte_count = wanted;
	return true;
}

static void deliver(cau_client *client)
{
	const unsigned char *message = client->message.bytes;
	size_t bytes = client->message.byte_count;
	client->message.byte_count = 0;
	if (!lws_frame_is_binary(client->wsi))
		cau_text_received(client, bytes ? (const char *)message : "", bytes);
	else if (bytes >= 4 && memcmp(message, "CAUC", 4) == 0)
		cau_chunk_received(client, message, bytes);
	else
		cau_frame_received(client, message, bytes);
}

static int receive(cau_client *client, const void *in, size_t bytes)
{
	if (!append(client, in, bytes)) {
		snprintf(client->close_reason, sizeof client->close_reason,
		         "the server sent a message larger than the protocol allows");
		return -1;
	}
	if (lws_is_final_fragment(client->wsi) && lws_remaining_packet_payload(client->wsi) == 0)
		deliver(client);
	return 0;
}

static void note_close(cau_client *client, const unsigned char *in, size_t bytes)
{
	if (bytes < 2)
		return;
	client->close_code = in[0] << 8 | in[1];
	snprintf(client->close_reason, sizeof client->close_reason, "%.*s", (int)bytes - 2,
	         (const char *)in + 2);
}

static void ended(cau_client *client)
{
	char reason[256];
	client->wsi = NULL;
	client->message.byte_count = 0;
	if (client->close_code)
		snprintf(reason, sizeof reason, "the server closed the connection: %s (%d)",
		         *client->close_reason ? client->close_reason : "no reason given",
		         client->close_code);
	else
		snprintf(reason, sizeof reason, "%s",
		         *client->close_reason ? client->close_reason : "the connection was lost");
	cau_client_lost(client, reason);
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t bytes)
{
	cau_client *client = user;
	if (!client) // the client is destroyed, or the event is of the context itself
		return 0;
	switch (reason) {
	case LWS_CALLBACK_CLIENT_ESTABLISHED:
		client->wsi = wsi;
		cau_client_opened(client);
		return 0;
	case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
		cau_client_not_opened(client, wsi, in, bytes);
		return 0;
	case LWS_CALLBACK_CLIENT_RECEIVE:
		return receive(client, in, bytes);
	case LWS_CALLBACK_CLIENT_WRITEABLE:
		return write_one(client);
	case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
		note_close(client, in, bytes);
		return 0;
	case LWS_CALLBACK_CLIENT_CLOSED:
		ended(client);
		return 0;
	default:
		return 0;
	}
}

// ---- event loop --------------------------------------------------------------------------------
static const struct lws_protocols protocols[] = {
	{.name = CAU_SUBPROTOCOL, .callback = on_event, .rx_buffer_size = RECEIVE_BYTES},
	{.name = CAU_FLEET_PROTOCOL, .callback = cau_fleet_on_event},
	{0},
};

cau_status cau_loop_create(cau_loop **loop, cau_error *error)
{
	struct lws_context_creation_info info = {
		.port = CONTEXT_PORT_NO_LISTEN,
		.protocols = protocols,
		.options = LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT,
		.pt_serv_buf_size = RECEIVE_BYTES,
		.gid = -1,
		.uid = -1,
	};
	lws_set_log_level(0, NULL); // Failures are reported as cau_error instead.
	*loop = calloc(1, sizeof **loop);
	if (*loop)
		(*loop)->context = lws_create_context(&info);
	if (*loop && (*loop)->context)
		return CAU_OK;
	free(*loop);
	*loop = NULL;
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for an event loop");
}
