// SPDX-License-Identifier: Apache-2.0
// Opens a client's connection, says hello, passes on received messages, detects the loss of the
// connection and reconnects.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "library/internal.h"

enum {
	WIRE_VERSION = 1,
	HELLO_ID = 0,
	HELLO_BYTES_MAX = 4096,
	FIRST_RETRY_US = 100000,
	LAST_RETRY_US = 2000000,
	// largest number of attempts to follow a session, for a client that does not reconnect
	// otherwise
	FOLLOWS_MOST = 5,
};

static void set_condition(cau_client *client, cau_client_condition condition)
{
	client->condition = condition;
	if (client->def.on_condition)
		client->def.on_condition(client->def.user, client, condition);
}

void cau_client_forget_timers(cau_client *client)
{
	lws_sul_cancel(&client->tick);
	lws_sul_cancel(&client->retry);
	lws_sul_cancel(&client->deadline);
}

// ---- open --------------------------------------------------------------------------------------
// Returns the interval of heartbeats. Five heartbeats fit into the silence after which the server
// turns energy off, because a busy machine may send or receive some of them late.
static lws_usec_t tick_us(const cau_client *client)
{
	const double share = 5, least_us = 10000;
	double wanted_us = 1e6 * client->server.limits.heartbeat_s / share;
	return (lws_usec_t)fmin(CAU_CLIENT_TICK_US, fmax(least_us, wanted_us));
}

void cau_client_beat(cau_client *client)
{
	const cau_wire_heartbeat beat = {.visible = true,
	                                 .has_client_time_us = true,
	                                 .client_time_us = (int64_t)(1e6 * cau_client_now())};
	cau_client_notify(client, CAU_METHOD_HEARTBEAT, &beat, NULL);
}

static void tick(lws_sorted_usec_list_t *timer)
{
	cau_client *client = lws_container_of(timer, cau_client, tick);
	lws_sul_schedule(client->loop->context, 0, &client->tick, tick, tick_us(client));
	if (client->keep_alive)
		cau_client_beat(client);
	cau_streams_tick(client);
}

// ---- hello -------------------------------------------------------------------------------------
// Sends hello, the first message on a connection.
static cau_status send_hello(cau_client *client, cau_error *error)
{
	char text[HELLO_BYTES_MAX];
	cau_rpc_buffer out = {text, sizeof text, 0};
	cau_wire_hello hello = {.version = WIRE_VERSION};
	bool again = client->connections > 0;
	snprintf(hello.client, sizeof hello.client, "%s", client->name);
	hello.has_token = *client->token;
	memcpy(hello.token, client->token, sizeof client->token);
	// A reconnecting client keeps its identity, because the stored answers belong to that identity.
	const char *id = again ? client->server.client_id : client->client_id;
	hello.has_client_id = *id;
	snprintf(hello.client_id, sizeof hello.client_id, "%s", id);
	hello.has_resume = again;
	const char *token =
		*client->follow.kept_resume ? client->follow.kept_resume : client->server.resume;
	snprintf(hello.resume, sizeof hello.resume, "%s", token);
	hello.has_role = client->def.role >= 0;
	hello.role = client->def.role;
	cau_status status = cau_rpc_write_request(&out, HELLO_ID, CAU_METHOD_HELLO, &hello, error);
	if (!status)
		status = cau_socket_send(client, false, text, out.bytes, NULL, 0, error);
	return status;
}

// Closes the connection without reconnecting.
static void refuse(cau_client *client, const cau_error *error)
{
	client->trouble = *error;
	client->closing = true;
	lws_callback_on_writable(client->wsi);
}

void cau_client_opened(cau_client *client)
{
	cau_error error = {0};
	if (send_hello(client, &error))
		refuse(client, &error);
}

static void become_ready(cau_client *client)
{
	client->attempts = 0;
	client->follow.now = false;
	client->connections++;
	lws_sul_cancel(&client->deadline);
	lws_sul_schedule(client->loop->context, 0, &client->tick, tick, tick_us(client));
	client->condition = CAU_CLIENT_READY;
	cau_streams_rejoin(client);
	cau_calls_resend(client);
	set_condition(client, CAU_CLIENT_READY);
}

// Reads the answer to hello.
static cau_status read_answer(cau_client *client, const cau_rpc_message *message, cau_error *error)
{
	if (message->kind == CAU_RPC_ERROR) {
		client->fault = message->fault;
		cau_error_of_fault(&message->fault, error);
		return error->status;
	}
	cau_wire_hello_result server = {0};
	cau_status status = cau_rpc_result(message, CAU_METHOD_HELLO, &server, error);
	if (!status)
		client->server = server;
	return status;
}

static void greeted(cau_client *client, const cau_rpc_message *message)
{
	cau_error error = {0};
	if (read_answer(client, message, &error))
		refuse(client, &error);
	else
		become_ready(client);
}

// ---- messages ----------------------------------------------------------------------------------
static void answered(cau_client *client, const cau_rpc_message *message)
{
	if (message->id.kind != CAU_RPC_ID_NUMBER)
		return; // an answer to a message that the server could not read, or without an id
	if (message->id.number == 0 && client->condition == CAU_CLIENT_CONNECTING)
		greeted(client, message);
	else
		cau_calls_answered(client, message);
}

static void notified(cau_client *client, const cau_rpc_message *message)
{
	if (message->method == CAU_METHOD_SESSION_CHANGED)
		cau_streams_changed(client, message);
	if (client->def.on_notification)
		client->def.on_notification(client->def.user, client, message);
}

void cau_text_received(cau_client *client, const char *text, size_t bytes)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	if (cau_rpc_read(text, bytes, CAU_CLIENT_TEXT_MAX, &message, &fault))
		return; // perhaps a message of a later version; a caller that waits for it times out
	if (message.kind == CAU_RPC_RESULT || message.kind == CAU_RPC_ERROR)
		answered(client, &message);
	else
		notified(client, &message);
	cau_rpc_finish(&message);
}

// ---- lost --------------------------------------------------------------------------------------
static void retry(lws_sorted_usec_list_t *timer)
{
	cau_client_begin(lws_container_of(timer, cau_client, retry));
}

// True for close codes that a new connection would get again.
static bool is_final(int code)
{
	switch (code) {
	case CAU_CLOSE_DONE:
	case CAU_CLOSE_PROTOCOL:
	case CAU_CLOSE_UNSUPPORTED:
	case CAU_CLOSE_NOT_UTF8:
	case CAU_CLOSE_TOO_BIG:
	case CAU_CLOSE_UNAUTHORIZED:
	case CAU_CLOSE_VERSION:
	case CAU_CLOSE_RATE:
	case CAU_CLOSE_RESUMED:
	case CAU_CLOSE_GARBAGE:
		return true;
	default:
		return false;
	}
}

void cau_client_lost(cau_client *client, const char *reason)
{
	bool follows = client->follow.now && client->attempts < FOLLOWS_MOST;
	bool again = (client->def.reconnect || follows) && client->connections > 0 &&
	             !client->closing && !is_final(client->close_code);
	cau_client_forget_timers(client);
	cau_outbox_clear(&client->outbox);
	if (!client->closing || !client->trouble.status)
		cau_fail(&client->trouble, CAU_IO, NULL, "%s", reason);
	cau_streams_lost(client);
	if (again) {
		// The first attempt to reach the session's new daemon starts at once.
		bool at_once = client->follow.now && !client->attempts && !client->follow.ways;
		int before =
			client->follow.now ? client->attempts + client->follow.ways - 1 : client->attempts;
		double wait_us = at_once ? 0 : fmin(LAST_RETRY_US, FIRST_RETRY_US * exp2(before));
		lws_sul_schedule(client->loop->context, 0, &client->retry, retry, (lws_usec_t)wait_us);
	}
	client->closing = false;
	client->condition = again ? CAU_CLIENT_LOST : CAU_CLIENT_CLOSED;
	cau_calls_lost(client, !again);
	set_condition(client, client->condition);
}

// ---- opening -----------------------------------------------------------------------------------
// Reads an HTTP answer that is not an upgrade: the status, and the daemon's reason. The reason is
// in a header, because libwebsockets does not give the body of such an answer. Returns false if
// there was no such answer.
static bool read_refusal(struct lws *wsi, char *text, size_t bytes)
{
	static const char header[] = "cautery-reason:";
	char reason[200];
	unsigned status = wsi ? lws_http_client_http_response(wsi) : 0;
	if (status < 200) // there is no answer, or the answer is an upgrade
		return false;
	if (lws_hdr_custom_copy(wsi, reason, sizeof reason, header, sizeof header - 1) <= 0)
		snprintf(reason, sizeof reason, "no reason given; is this a cauteryd?");
	snprintf(text, bytes, "the server answered HTTP %u: %s", status, reason);
	return true;
}

void cau_client_not_opened(cau_client *client, struct lws *wsi, const char *in, size_t bytes)
{
	char reason[480], why[260] = "nothing answered";
	if (!read_refusal(wsi, why, sizeof why) && in && bytes < 120)
		snprintf(why, sizeof why, "%.*s", (int)bytes, in);
	snprintf(reason, sizeof reason, "no connection to %.160s port %d: %s", client->url.host,
	         client->url.port, why);
	if (client->url.tls && strstr(why, "SSL"))
		snprintf(reason + strlen(reason), sizeof reason - strlen(reason),
		         " (is its certificate trusted? SSL_CERT_FILE names a file of authorities)");
	client->wsi = NULL;
	cau_client_lost(client, reason);
}

static void open_socket(cau_client *client)
{
	char host[280], path[16 + CAU_NAME_BYTES];
	bool bare = strchr(client->url.host, ':') == NULL; // false for an IPv6 address
	snprintf(host, sizeof host, bare ? "%s:%d" : "[%s]:%d", client->url.host, client->url.port);
	const char *name = *client->session ? client->session : client->label;
	const char *query = *client->session ? "?session=" : *client->label ? "?label=" : "";
	snprintf(path, sizeof path, "/v1%s%s", query, name);
	struct lws_client_connect_info info = {
		.context = client->loop->context,
		.address = client->url.host,
		.port = client->url.port,
		.ssl_connection = client->url.tls ? LCCSCF_USE_SSL : 0,
		.path = path,
		.host = host,
		.protocol = CAU_SUBPROTOCOL,
		.local_protocol_name = CAU_SUBPROTOCOL,
		.ietf_version_or_minus_one = -1,
		.alpn = "http/1.1",
		.userdata = client,
	};
	client->close_code = 0;
	client->close_reason[0] = 0;
	client->wsi = lws_client_connect_via_info(&info);
	if (!client->wsi && client->condition == CAU_CLIENT_CONNECTING)
		cau_client_not_opened(client, NULL, NULL, 0);
}

static void too_late(lws_sorted_usec_list_t *timer)
{
	cau_client *client = lws_container_of(timer, cau_client, deadline);
	snprintf(client->close_reason, sizeof client->close_reason, "no answer to hello within %g s",
	         client->def.timeout_s);
	cau_socket_cut(client);
}

void cau_client_begin(cau_client *client)
{
	client->attempts++;
	lws_sul_schedule(client->loop->context, 0, &client->deadline, too_late,
	                 (lws_usec_t)(client->def.timeout_s * 1e6));
	set_condition(client, CAU_CLIENT_CONNECTING);
	open_socket(client);
}
