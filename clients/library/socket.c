// SPDX-License-Identifier: GPL-3.0-or-later
// The WebSocket: messages put together, messages written, and how it ended.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "library/internal.h"

enum { RECEIVE_BYTES = 65536 };

#define SUBPROTOCOL "cautery.v1"

// What an HTTP answer that is no upgrade says: its status, and the reason that the daemon gives in
// a header, since libwebsockets shows no body of such an answer. False if there was none.
static bool read_refusal(struct lws *wsi, char *text, size_t bytes)
{
	static const char header[] = "cautery-reason:";
	char reason[200];
	unsigned status = wsi ? lws_http_client_http_response(wsi) : 0;
	if (status < 200) // none, or an upgrade
		return false;
	if (lws_hdr_custom_copy(wsi, reason, sizeof reason, header, sizeof header - 1) <= 0)
		snprintf(reason, sizeof reason, "no reason given; is this a cauteryd?");
	snprintf(text, bytes, "it answered HTTP %u: %s", status, reason);
	return true;
}

static void not_opened(cau_client *client, struct lws *wsi, const char *in, size_t bytes)
{
	char reason[480], why[260] = "nothing answered";
	if (!read_refusal(wsi, why, sizeof why) && in && bytes < 120)
		snprintf(why, sizeof why, "%.*s", (int)bytes, in);
	snprintf(reason, sizeof reason, "no connection to %.160s port %d: %s", client->url.host,
	         client->url.port, why);
	client->wsi = NULL;
	cau_client_lost(client, reason);
}

void cau_socket_open(cau_client *client)
{
	char host[280], path[64];
	bool bare = strchr(client->url.host, ':') == NULL; // no IPv6 address
	snprintf(host, sizeof host, bare ? "%s:%d" : "[%s]:%d", client->url.host, client->url.port);
	snprintf(path, sizeof path, *client->session ? "/v1?session=%s" : "/v1", client->session);
	struct lws_client_connect_info info = {
		.context = client->loop->context,
		.address = client->url.host,
		.port = client->url.port,
		.ssl_connection = client->url.tls ? LCCSCF_USE_SSL : 0,
		.path = path,
		.host = host,
		.protocol = SUBPROTOCOL,
		.local_protocol_name = SUBPROTOCOL,
		.ietf_version_or_minus_one = -1,
		.alpn = "http/1.1",
		.userdata = client,
	};
	client->close_code = 0;
	client->close_reason[0] = 0;
	client->wsi = lws_client_connect_via_info(&info);
	if (!client->wsi && client->condition == CAU_CLIENT_CONNECTING)
		not_opened(client, NULL, NULL, 0);
}

void cau_socket_cut(cau_client *client)
{
	if (client->wsi)
		lws_set_timeout(client->wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
}

cau_status cau_socket_send(cau_client *client, bool binary, const void *head, size_t head_bytes,
                           const void *body, size_t body_bytes, cau_error *error)
{
	if (!client->wsi)
		return cau_fail(error, CAU_IO, NULL, "not connected");
	cau_status status =
		cau_outbox_add(&client->outbox, binary, head, head_bytes, body, body_bytes, error);
	if (!status)
		lws_callback_on_writable(client->wsi);
	return status;
}

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
	size_t wanted = client->message_bytes + bytes;
	size_t most = lws_frame_is_binary(client->wsi) ? (size_t)CAU_CLIENT_BINARY_MAX
	                                               : (size_t)CAU_CLIENT_TEXT_MAX;
	if (wanted > most)
		return false;
	if (wanted > client->message_capacity) {
		size_t capacity = client->message_capacity ? client->message_capacity : 8192;
		while (capacity < wanted)
			capacity *= 2;
		void *grown = realloc(client->message, capacity);
		if (!grown)
			return false;
		client->message = grown;
		client->message_capacity = capacity;
	}
	if (bytes)
		memcpy(client->message + client->message_bytes, in, bytes);
	client->message_bytes = wanted;
	return true;
}

static void deliver(cau_client *client)
{
	const unsigned char *message = client->message;
	size_t bytes = client->message_bytes;
	client->message_bytes = 0;
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
		         "the server sent a message larger than any that is expected");
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
	client->message_bytes = 0;
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
	if (!client) // destroyed, or an event of the context itself
		return 0;
	switch (reason) {
	case LWS_CALLBACK_CLIENT_ESTABLISHED:
		client->wsi = wsi;
		cau_client_opened(client);
		return 0;
	case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
		not_opened(client, wsi, in, bytes);
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

const struct lws_protocols cau_client_protocols[] = {
	{.name = SUBPROTOCOL, .callback = on_event, .rx_buffer_size = RECEIVE_BYTES},
	{0},
};
