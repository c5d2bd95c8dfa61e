// SPDX-License-Identifier: GPL-3.0-or-later
// Messages from workers and the store thread to connections. They wait here for the network thread
// (delivery.c).
#include <stdlib.h>
#include <string.h>

#include "cautery/json_writer.h"
#include "rpc/internal.h"

enum { ID_BYTES = 6 * CAU_RPC_ID_BYTES + 3 };

static void put(cau_service *service, cau_post *post)
{
	pthread_mutex_lock(&service->mutex);
	if (service->last)
		service->last->next = post;
	else
		service->first = post;
	service->last = post;
	pthread_mutex_unlock(&service->mutex);
	if (service->network)
		cau_network_wake(service->network);
}

static size_t write_id(char text[ID_BYTES], const cau_rpc_id *id)
{
	size_t bytes = 0;
	cau_json_writer writer;
	cau_json_begin(&writer, text, ID_BYTES, 0);
	if (id->kind == CAU_RPC_ID_NUMBER)
		cau_json_integer(&writer, NULL, id->number);
	else if (id->kind == CAU_RPC_ID_TEXT)
		cau_json_string(&writer, NULL, id->text);
	else
		cau_json_null(&writer, NULL);
	cau_json_end(&writer, &bytes, NULL);
	return bytes;
}

cau_buffer *cau_answer_with_id(const char *text, size_t bytes, const cau_rpc_id *id)
{
	static const char member[] = "\"id\":";
	char own[ID_BYTES];
	const char *found = memmem(text, bytes, member, sizeof member - 1);
	if (!found)
		return NULL;
	size_t own_bytes = write_id(own, id);
	size_t head = (size_t)(found - text) + sizeof member - 1;
	size_t skipped = head + strcspn(text + head, ",");
	cau_buffer *buffer = cau_buffer_create(head + own_bytes + bytes - skipped, false);
	if (!buffer)
		return NULL;
	unsigned char *to = cau_buffer_bytes(buffer);
	memcpy(to, text, head);
	memcpy(to + head, own, own_bytes);
	memcpy(to + head + own_bytes, text + skipped, bytes - skipped);
	return buffer;
}

static cau_buffer *fault_text(const cau_rpc_id *id, const cau_outcome *outcome)
{
	enum { FAULT_BYTES = 4096 };
	cau_buffer *buffer = cau_buffer_create(FAULT_BYTES, false);
	cau_rpc_fault fault;
	if (!buffer)
		return NULL;
	cau_rpc_buffer out = {(char *)cau_buffer_bytes(buffer), FAULT_BYTES, 0};
	cau_rpc_fault_of_error(&fault, outcome->error);
	if (outcome->code) {
		cau_rpc_fault_of_code(&fault, (cau_rpc_error_code)outcome->code, outcome->error->reason);
		snprintf(fault.path, sizeof fault.path, "%s", outcome->error->path);
	}
	if (outcome->moved) {
		memcpy(fault.moved_to, outcome->moved->session, sizeof fault.moved_to);
		memcpy(fault.url, outcome->moved->url, sizeof fault.url);
	}
	if (cau_rpc_write_error(&out, id, &fault, NULL)) {
		cau_buffer_release(buffer);
		return NULL;
	}
	buffer->byte_count = out.bytes;
	return buffer;
}

static int32_t code_of(const cau_outcome *outcome)
{
	if (!outcome->error)
		return 0;
	return outcome->code ? outcome->code : (int32_t)cau_rpc_error_of_status(outcome->error->status);
}

void cau_service_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	cau_service *service = user;
	cau_post *post = calloc(1, sizeof *post);
	if (!post)
		return;
	cau_answers_count(service, reply->method, code_of(outcome));
	post->kind = POST_ANSWER;
	post->connection = reply->connection;
	post->id = reply->id;
	post->method = reply->method;
	post->text = outcome->error
	                 ? fault_text(&reply->id, outcome)
	                 : cau_answer_with_id(outcome->text, outcome->text_bytes, &reply->id);
	if (!outcome->error && outcome->file)
		post->file = cau_buffer_share(outcome->file);
	post->transfer = outcome->transfer;
	if (!outcome->error && outcome->joined)
		post->joined = cau_hosted_share(outcome->joined);
	post->stream = outcome->stream;
	put(service, post);
}

void cau_service_notify(void *user, cau_audience audience, cau_buffer *text)
{
	cau_post *post = calloc(1, sizeof *post);
	if (!post) {
		cau_buffer_release(text);
		return;
	}
	post->kind = POST_NOTICE;
	post->audience = audience;
	post->text = text;
	put(user, post);
}

void cau_service_frames(void *user)
{
	cau_service *service = user;
	if (!atomic_exchange(&service->frames_waiting, true) && service->network)
		cau_network_wake(service->network);
}
