// SPDX-License-Identifier: Apache-2.0
// Sends requests and notifications to the server and receives answers.
#include <stdlib.h>
#include <string.h>

#include "library/internal.h"

enum { FIRST_CAPACITY = 2048 };

// A message text, allocated with the size that the writer needs. The caller frees it.
typedef struct message_text {
	char *bytes;
	size_t byte_count;
} message_text;

typedef struct writing { // the content of one message
	int64_t id;          // negative for a notification
	cau_method method;
	const void *params;
	const cau_rpc_envelope *envelope; // session and sequence of a command, or NULL
	const cau_command *command;       // NULL if it is not a command
} writing;

static cau_status write_once(const writing *w, cau_rpc_buffer *out, cau_error *error)
{
	if (w->command)
		return cau_rpc_write_command(out, w->id < 0 ? NULL : &w->id, w->envelope, w->command,
		                             error);
	if (w->id < 0)
		return cau_rpc_write_notification(out, w->method, w->params, error);
	return cau_rpc_write_request(out, w->id, w->method, w->params, error);
}

// Replaces the session id that the program knows by the session's present id.
static cau_status rename_session(const cau_client *client, size_t room_before, message_text *made,
                                 cau_error *error)
{
	size_t bytes = made->byte_count;
	char *text =
		cau_follow_text(client->follow.from, client->follow.to, made->bytes + room_before, &bytes);
	if (!text)
		return CAU_OK;
	char *grown = realloc(made->bytes, room_before + bytes + 1);
	if (grown) {
		made->bytes = grown;
		made->byte_count = bytes;
		memcpy(grown + room_before, text, bytes + 1);
	}
	free(text);
	return grown ? CAU_OK : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a message");
}

static cau_status write_text(const cau_client *client, const writing *w, size_t room_before,
                             message_text *made, cau_error *error)
{
	size_t capacity = FIRST_CAPACITY;
	cau_status status = CAU_LIMIT;
	*made = (message_text){0};
	for (int i = 0; i < 2 && status == CAU_LIMIT; i++) {
		char *grown = realloc(made->bytes, room_before + capacity);
		if (!grown) {
			status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a message");
			break;
		}
		made->bytes = grown;
		cau_rpc_buffer out = {grown + room_before, capacity, 0};
		status = write_once(w, &out, error);
		made->byte_count = out.bytes;
		capacity = out.bytes + 1;
	}
	if (!status)
		status = rename_session(client, room_before, made, error);
	if (status) {
		free(made->bytes);
		made->bytes = NULL;
	}
	return status;
}

// ---- sending -----------------------------------------------------------------------------------
// True if the same text may be sent again on another connection.
static bool can_resend(cau_method method, const char *sent, size_t bytes)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	cau_rpc_envelope envelope = {0};
	switch (method) {
	case CAU_METHOD_UPLOAD_BEGIN: // a transfer ends with its connection
	case CAU_METHOD_UPLOAD_END:
	case CAU_METHOD_SESSION_EXPORT:
	case CAU_METHOD_SESSION_LOG:
	case CAU_METHOD_SESSION_JOIN: // the client joins again without the program
		return false;
	default:
		break;
	}
	if (!cau_method_describe(method)->changes)
		return true;
	if (cau_rpc_read(sent, bytes, CAU_CLIENT_TEXT_MAX, &message, &fault))
		return false;
	bool known = !cau_rpc_envelope_read(&message, &envelope, NULL) && envelope.has_client_sequence;
	cau_rpc_finish(&message);
	return known;
}

static cau_status send_request(cau_client *client, const writing *w, cau_client_answer *answer,
                               void *user, cau_error *error)
{
	message_text made;
	if (client->condition == CAU_CLIENT_IDLE || client->condition == CAU_CLIENT_CLOSED)
		return cau_fail(error, CAU_IO, NULL, "not connected%s%s",
		                *client->trouble.reason ? ": " : "", client->trouble.reason);
	cau_status status = write_text(client, w, sizeof(cau_client_pending), &made, error);
	if (status)
		return status;
	cau_client_pending *pending = (cau_client_pending *)made.bytes;
	*pending = (cau_client_pending){.id = w->id,
	                                .method = w->method,
	                                .answer = answer,
	                                .user = user,
	                                .byte_count = made.byte_count};
	pending->resendable = can_resend(w->method, pending->text, pending->byte_count);
	if (client->condition == CAU_CLIENT_READY &&
	    !client->follow.now) // Otherwise the request is sent after the answer to hello.
		status = cau_socket_send(client, false, pending->text, pending->byte_count, NULL, 0, error);
	if (status) {
		free(pending);
		return status;
	}
	cau_pending_add(client, pending);
	return CAU_OK;
}

int64_t cau_client_next_sequence(cau_client *client)
{
	return ++client->last_sequence;
}

cau_status cau_client_send(cau_client *client, cau_method method, const void *params,
                           cau_client_answer *answer, void *user, cau_error *error)
{
	writing w = {.id = ++client->last_id, .method = method, .params = params};
	return send_request(client, &w, answer, user, error);
}

static cau_method method_of(const cau_command *command)
{
	int method = 0;
	while (method < CAU_METHOD_COUNT &&
	       cau_method_describe((cau_method)method)->command != command->kind)
		method++;
	return (cau_method)method;
}

static cau_rpc_envelope envelope_of(const char *session)
{
	cau_rpc_envelope envelope = {.has_session = session && *session};
	snprintf(envelope.session, sizeof envelope.session, "%s", session ? session : "");
	return envelope;
}

cau_status cau_client_send_command(cau_client *client, const char *session,
                                   const cau_command *command, cau_client_answer *answer,
                                   void *user, cau_error *error)
{
	cau_rpc_envelope envelope = envelope_of(session);
	envelope.has_client_sequence = true;
	envelope.client_sequence = cau_client_next_sequence(client);
	writing w = {++client->last_id, method_of(command), NULL, &envelope, command};
	return send_request(client, &w, answer, user, error);
}

static cau_status send_notification(cau_client *client, const writing *w, cau_error *error)
{
	message_text made;
	if (client->condition != CAU_CLIENT_READY)
		return cau_fail(error, CAU_IO, NULL, "not connected");
	cau_status status = write_text(client, w, 0, &made, error);
	if (!status)
		status = cau_socket_send(client, false, made.bytes, made.byte_count, NULL, 0, error);
	free(made.bytes);
	return status;
}

cau_status cau_client_notify(cau_client *client, cau_method method, const void *params,
                             cau_error *error)
{
	return send_notification(client, &(writing){.id = -1, .method = method, .params = params},
	                         error);
}

cau_status cau_client_move(cau_client *client, const char *session, const cau_command *command,
                           cau_error *error)
{
	cau_rpc_envelope envelope = envelope_of(session);
	return send_notification(client, &(writing){-1, CAU_METHOD_TOOL_MOVE, NULL, &envelope, command},
	                         error);
}

// ---- answers -----------------------------------------------------------------------------------
void cau_error_of_fault(const cau_rpc_fault *fault, cau_error *error)
{
	cau_status status = CAU_BAD_STATE;
	const char *sentence = cau_rpc_error_sentence(fault->code);
	bool more = *fault->reason && strcmp(fault->reason, sentence) != 0;
	for (int i = 1; i < CAU_STATUS_COUNT; i++)
		if (strcmp(fault->status, cau_status_name((cau_status)i)) == 0)
			status = (cau_status)i;
	cau_fail(error, status, fault->path, "%s%s%s", sentence, more ? ": " : "",
	         more ? fault->reason : "");
}

static void fail_pending(cau_client_pending *pending, const cau_error *error)
{
	if (pending->answer)
		pending->answer(pending->user, NULL, error);
	free(pending);
}

void cau_calls_answered(cau_client *client, const cau_rpc_message *message)
{
	cau_error error = {0};
	cau_client_pending *pending = cau_pending_take(client, message->id.number);
	if (!pending)
		return; // already answered on an earlier connection
	if (message->kind == CAU_RPC_ERROR && cau_follow_answer(client, pending, &message->fault))
		return;
	if (message->kind == CAU_RPC_ERROR) {
		client->fault = message->fault;
		cau_error_of_fault(&message->fault, &error);
		fail_pending(pending, &error);
		return;
	}
	cau_follow_found(client);
	if (pending->answer)
		pending->answer(pending->user, message, NULL);
	free(pending);
	if (client->follow.now)
		cau_follow_when_answered(client);
}

void cau_calls_lost(cau_client *client, bool all)
{
	cau_error error = {0};
	cau_client_pending *kept_first = NULL, *kept_last = NULL, *pending = client->first_pending;
	client->first_pending = client->last_pending = NULL;
	for (cau_client_pending *next; pending; pending = next) {
		next = pending->next;
		if (!all && pending->resendable) {
			pending->next = NULL;
			pending->again = false;
			if (kept_last)
				kept_last->next = pending;
			else
				kept_first = pending;
			kept_last = pending;
			continue;
		}
		cau_fail(&error, CAU_IO, NULL, "%s; whether %s took effect is not known",
		         *client->trouble.reason ? client->trouble.reason : "the client was ended",
		         cau_method_describe(pending->method)->name);
		fail_pending(pending, &error);
	}
	client->first_pending = kept_first;
	client->last_pending = kept_last;
}

void cau_calls_resend(cau_client *client)
{
	for (cau_client_pending *p = client->first_pending; p; p = p->next)
		if (cau_socket_send(client, false, p->text, p->byte_count, NULL, 0, NULL))
			return; // The outbox is full. The remaining requests are sent with the next connection.
}

const cau_rpc_fault *cau_client_fault(const cau_client *client)
{
	return &client->fault;
}
