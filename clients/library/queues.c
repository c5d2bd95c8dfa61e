// SPDX-License-Identifier: Apache-2.0
// What waits: messages in the outbox, requests without an answer, and the program in the event loop
// that socket.c creates.
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "library/internal.h"

// ---- outbox ------------------------------------------------------------------------------------
unsigned char *cau_outbox_bytes(cau_outbox_message *message)
{
	return message->bytes + LWS_PRE;
}

cau_status cau_outbox_add(cau_outbox *outbox, bool binary, const void *head, size_t head_bytes,
                          const void *body, size_t body_bytes, cau_error *error)
{
	size_t bytes = head_bytes + body_bytes;
	if (bytes > CAU_OUTBOX_BYTES_MAX - outbox->byte_count)
		return cau_fail(error, CAU_LIMIT, NULL,
		                "the connection is too slow: %zu bytes wait to be sent",
		                outbox->byte_count);
	cau_outbox_message *message = malloc(sizeof *message + LWS_PRE + bytes);
	if (!message)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a message of %zu bytes", bytes);
	message->next = NULL;
	message->binary = binary;
	message->byte_count = bytes;
	if (head_bytes)
		memcpy(cau_outbox_bytes(message), head, head_bytes);
	if (body_bytes)
		memcpy(cau_outbox_bytes(message) + head_bytes, body, body_bytes);
	if (outbox->last)
		outbox->last->next = message;
	else
		outbox->first = message;
	outbox->last = message;
	outbox->byte_count += bytes;
	return CAU_OK;
}

cau_outbox_message *cau_outbox_take(cau_outbox *outbox)
{
	cau_outbox_message *message = outbox->first;
	if (!message)
		return NULL;
	outbox->first = message->next;
	if (!outbox->first)
		outbox->last = NULL;
	outbox->byte_count -= message->byte_count;
	return message;
}

void cau_outbox_clear(cau_outbox *outbox)
{
	for (cau_outbox_message *message; (message = cau_outbox_take(outbox));)
		free(message);
}

// ---- sending -----------------------------------------------------------------------------------
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

// ---- requests without an answer ----------------------------------------------------------------
// They are in one list, in the order in which they were sent.

void cau_pending_add(cau_client *client, cau_client_pending *pending)
{
	pending->next = NULL;
	if (client->last_pending)
		client->last_pending->next = pending;
	else
		client->first_pending = pending;
	client->last_pending = pending;
}

cau_client_pending *cau_pending_take(cau_client *client, int64_t id)
{
	cau_client_pending *before = NULL, *pending = client->first_pending;
	while (pending && pending->id != id) {
		before = pending;
		pending = pending->next;
	}
	if (!pending)
		return NULL;
	if (before)
		before->next = pending->next;
	else
		client->first_pending = pending->next;
	if (client->last_pending == pending)
		client->last_pending = before;
	return pending;
}

// ---- waiting -----------------------------------------------------------------------------------
double cau_client_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void cau_loop_destroy(cau_loop *loop)
{
	if (!loop)
		return;
	lws_context_destroy(loop->context);
	free(loop);
}

static void woken(lws_sorted_usec_list_t *wake)
{
	(void)wake; // The timer's only purpose is to end the wait.
}

void cau_loop_wait(cau_loop *loop, double seconds)
{
	if (seconds <= 0) {
		lws_service(loop->context, -1);
		return;
	}
	lws_sul_schedule(loop->context, 0, &loop->wake, woken, (lws_usec_t)(seconds * 1e6) + 1);
	lws_service(loop->context, 0);
	lws_sul_cancel(&loop->wake);
}
