// SPDX-License-Identifier: GPL-3.0-or-later
// Answers that the network thread makes by itself, and orders of a call.
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

// ---- signs of life
double cau_peer_alive_s(const cau_peer *peer)
{
	return peer->sign.clocked ? peer->sign.alive_s
	                          : cau_connection_sent_after_s(peer->connection, cau_monotonic_s());
}

// Notes the peer's clock. A heartbeat that may have waited for a long time is not used as the first
// heartbeat, because nothing shows how long it waited.
void cau_peer_hear_clock(cau_peer *peer, int64_t client_time_us)
{
	double now_s = cau_monotonic_s();
	if (peer->sign.clocked || cau_connection_sent_after_s(peer->connection, now_s) >= now_s)
		cau_sign_of_life_hear(&peer->sign, now_s, 1e-6 * (double)client_time_us,
		                      peer->client.asker.deadline_s);
}

enum { FIRST_BYTES = 4096, FAULT_BYTES = 4096 };

void cau_peer_fault(cau_peer *peer, const cau_rpc_id *id, const cau_rpc_fault *fault)
{
	cau_buffer *buffer = cau_buffer_create(FAULT_BYTES, false);
	cau_rpc_buffer out = {.capacity = FAULT_BYTES};
	cau_error error = {0};
	peer->service->errors++;
	if (!buffer)
		return;
	out.buffer = (char *)cau_buffer_bytes(buffer);
	if (cau_rpc_write_error(&out, id, fault, &error)) {
		cau_log(CAU_LOG_ERROR, NULL, "answer_lost", "reason=\"%s\"", error.reason);
		cau_buffer_release(buffer);
		return;
	}
	buffer->byte_count = out.bytes;
	cau_connection_send(peer->connection, buffer);
}

void cau_peer_malformed(cau_peer *peer)
{
	if (++peer->malformed >= MALFORMED_MOST)
		cau_connection_close(peer->connection, CAU_CLOSE_GARBAGE, NULL);
}

// Logs the reason for a refused notification, because it is never answered. Each connection has at
// most one such line, after its hello.
static void log_refused(cau_peer *peer, cau_method method, const cau_rpc_fault *fault)
{
	if (!peer->greeted || peer->refusal_logged)
		return;
	peer->refusal_logged = true;
	cau_log(CAU_LOG_WARNING, NULL, "notification_refused",
	        "connection=%llu name=\"%s\" method=%s path=%s reason=\"%s\"",
	        (unsigned long long)peer->connection->id, peer->client.asker.name,
	        cau_answers_method_name(method), fault->path, fault->reason);
}

void cau_peer_refuse(cau_peer *peer, const cau_rpc_message *message, cau_method method,
                     const cau_rpc_fault *fault)
{
	if (message->kind == CAU_RPC_NOTIFICATION) {
		log_refused(peer, method, fault);
		return;
	}
	cau_answers_count(peer->service, method, fault->code);
	cau_peer_fault(peer, &message->id, fault);
}

static void fail_moved(const cau_call *call, const cau_moved_to *to)
{
	cau_rpc_fault fault;
	char reason[2 * CAU_NAME_BYTES];
	snprintf(reason, sizeof reason, "the session is now `%s`", to->session);
	cau_rpc_fault_of_code(&fault, CAU_RPC_MOVED, reason);
	snprintf(fault.path, sizeof fault.path, "params.session");
	memcpy(fault.moved_to, to->session, sizeof fault.moved_to);
	memcpy(fault.url, to->url, sizeof fault.url);
	cau_peer_refuse(call->peer, call->message, call->message->method, &fault);
}

void cau_call_fail(const cau_call *call, const cau_error *error, int32_t code)
{
	cau_rpc_fault fault;
	cau_rpc_fault_of_error(&fault, error);
	if (code) {
		cau_rpc_fault_of_code(&fault, (cau_rpc_error_code)code, error->reason);
		snprintf(fault.path, sizeof fault.path, "%s", error->path);
	}
	cau_peer_refuse(call->peer, call->message, call->message->method, &fault);
}

cau_buffer *cau_result_text(const cau_rpc_id *id, cau_method method, const void *result,
                            cau_error *error)
{
	size_t capacity = FIRST_BYTES;
	for (int attempt = 0; attempt < 2; attempt++) {
		cau_buffer *buffer = cau_buffer_create(capacity, false);
		if (!buffer) {
			cau_fail(error, CAU_NO_MEMORY, "", "no memory for the answer");
			return NULL;
		}
		cau_rpc_buffer out = {(char *)cau_buffer_bytes(buffer), capacity, 0};
		cau_status status = cau_rpc_write_result(&out, id, method, result, error);
		buffer->byte_count = out.bytes;
		capacity = out.bytes + 1;
		if (!status)
			return buffer;
		cau_buffer_release(buffer);
		if (status != CAU_LIMIT)
			return NULL;
	}
	return NULL;
}

void cau_call_answer(const cau_call *call, cau_buffer *text)
{
	cau_answers_count(call->peer->service, call->message->method, 0);
	cau_connection_send(call->peer->connection, text);
}

void cau_call_result(const cau_call *call, const void *result)
{
	cau_error error = {0};
	if (call->message->kind == CAU_RPC_NOTIFICATION)
		return;
	cau_buffer *text = cau_result_text(&call->message->id, call->message->method, result, &error);
	if (text)
		cau_call_answer(call, text);
	else
		cau_call_fail(call, &error, CAU_RPC_INTERNAL);
}

cau_reply cau_call_reply(const cau_call *call)
{
	cau_reply reply = {.method = call->message->method};
	if (call->message->kind == CAU_RPC_REQUEST) {
		reply.answer = cau_service_answer;
		reply.user = call->peer->service;
		reply.connection = call->peer->connection->id;
		reply.id = call->message->id;
	}
	return reply;
}

bool cau_call_may_use(const cau_call *call, const char *id)
{
	cau_error error = {0};
	if (cau_auth_session_allowed(&call->peer->bounds, id))
		return true;
	cau_fail(&error, CAU_BAD_STATE, "params.session",
	         "the token does not allow the session `%.48s`", id);
	cau_call_fail(call, &error, CAU_RPC_FORBIDDEN);
	return false;
}

bool cau_call_may_make(const cau_call *call, const char *name)
{
	cau_error error = {0};
	char id[2 * CAU_NAME_BYTES];
	snprintf(id, sizeof id, "%.48s-%s", call->peer->service->config->label, name);
	if (!*call->peer->bounds.sessions ||
	    (*name && cau_auth_session_allowed(&call->peer->bounds, id)))
		return true;
	cau_fail(&error, CAU_BAD_STATE, "params.name",
	         "the token allows only the sessions %s: give the new session such a name",
	         call->peer->bounds.sessions);
	cau_call_fail(call, &error, CAU_RPC_FORBIDDEN);
	return false;
}

// Returns the session that the message names, or else the connection's.
static const char *named_session(const cau_call *call)
{
	return call->envelope.has_session ? call->envelope.session : call->peer->session;
}

cau_hosted *cau_call_session(const cau_call *call)
{
	cau_error error = {0};
	cau_moved_to to;
	const char *id = named_session(call);
	if (!*id) {
		cau_fail(&error, CAU_BAD_VALUE, "params.session",
		         "missing: neither the message nor the connection's URL names a session");
		cau_call_fail(call, &error, 0);
		return NULL;
	}
	if (!cau_call_may_use(call, id))
		return NULL;
	cau_hosted *hosted = cau_hub_find(call->peer->service->hub, id);
	if (hosted)
		return hosted;
	int64_t sequence = call->envelope.has_client_sequence ? call->envelope.client_sequence : 0;
	cau_reply reply = cau_call_reply(call);
	if (call->method->changes &&
	    cau_hub_submit_missing(call->peer->service->hub, id, &call->peer->client.asker, sequence,
	                           &reply))
		return NULL;
	if (cau_hub_moved(call->peer->service->hub, id, &to)) {
		fail_moved(call, &to);
		return NULL;
	}
	cau_fail(&error, CAU_NOT_FOUND, "params.session", "no session `%.48s` on this daemon", id);
	cau_call_fail(call, &error, CAU_RPC_NOT_HERE);
	return NULL;
}

cau_order *cau_call_order(const cau_call *call, cau_order_kind kind)
{
	return cau_call_order_of(call, kind, 0);
}

cau_order *cau_call_order_of(const cau_call *call, cau_order_kind kind, size_t bytes)
{
	cau_error error = {0};
	cau_order *order = calloc(1, sizeof *order + bytes);
	if (!order) {
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the request");
		cau_call_fail(call, &error, 0);
		return NULL;
	}
	order->kind = kind;
	order->asker = call->peer->client.asker;
	order->alive_s = cau_peer_alive_s(call->peer);
	if (call->method->changes && call->envelope.has_client_sequence)
		order->client_sequence = call->envelope.client_sequence;
	order->reply = cau_call_reply(call);
	return order;
}

cau_order *cau_call_order_with(const cau_call *call, cau_order_kind kind, void *params)
{
	cau_error error = {0};
	cau_order *order = cau_call_order(call, kind);
	if (!order || !cau_rpc_params(call->message, params, &error))
		return order;
	cau_call_fail(call, &error, 0);
	free(order);
	return NULL;
}

void cau_call_submit(const cau_call *call, cau_order *order)
{
	cau_error error = {0};
	cau_hosted *hosted = cau_call_session(call);
	if (!hosted) {
		free(order);
		return;
	}
	bool file = call->method->cost == CAU_COST_FILE && order->reply.answer;
	cau_moved_to to;
	cau_status status = cau_hosted_submit(hosted, order, &error);
	if (status == CAU_NOT_FOUND &&
	    cau_hub_moved(call->peer->service->hub, named_session(call), &to)) {
		free(order); // the session was there a moment ago, when the order was made
		fail_moved(call, &to);
	} else if (status) {
		free(order);
		cau_call_fail(call, &error, status == CAU_IO ? CAU_RPC_STORE_FULL : 0);
	} else {
		call->peer->files_asked += file;
	}
	cau_hosted_release(hosted);
}
