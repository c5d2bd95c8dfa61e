// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/answer.h"

#include <stdlib.h>

#include "hosted_session/answer.h"
#include "hosted_session/internal.h"

enum { FIRST_BYTES = 4096 };

char *cau_answer_text(cau_method method, const void *result, size_t *bytes, cau_error *error)
{
	cau_rpc_buffer out = {.capacity = FIRST_BYTES};
	cau_rpc_id id = {.kind = CAU_RPC_ID_TEXT};
	cau_status status = CAU_LIMIT;
	snprintf(id.text, sizeof id.text, "%s", cau_method_describe(method)->name);
	for (int attempt = 0; attempt < 2 && status == CAU_LIMIT; attempt++) {
		char *grown = realloc(out.buffer, out.capacity);
		if (!grown) {
			status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for an answer");
			break;
		}
		out.buffer = grown;
		status = cau_rpc_write_result(&out, &id, method, result, error);
		if (status == CAU_LIMIT)
			out.capacity = out.bytes + 1;
	}
	if (!status) {
		*bytes = out.bytes;
		return out.buffer;
	}
	free(out.buffer);
	return NULL;
}

const cau_error cau_daemon_ends = {.status = CAU_BAD_STATE, .reason = "the daemon is ending"};

void cau_answer_now(const cau_reply *reply, const void *result)
{
	cau_error error = {0};
	cau_outcome outcome = {0};
	char *text = cau_answer_text(reply->method, result, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(reply, &outcome);
	free(text);
}

void cau_answer_fail(cau_order *order, const cau_error *error, int32_t code)
{
	cau_reply_fail(&order->reply, error, code);
	free(order);
}

cau_outcome_kind cau_answer_refuse(cau_order *order, cau_status status, const char *path,
                                   const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, path, "%s", reason);
	cau_answer_fail(order, &error, 0);
	return CAU_NOT_DONE;
}

void cau_answer_notify(const cau_hosted_identity *identity, cau_audience audience,
                       cau_method method, const void *params)
{
	cau_rpc_buffer out = {.capacity = FIRST_BYTES};
	cau_buffer *buffer = cau_buffer_create(FIRST_BYTES, false);
	cau_error error = {0};
	if (!buffer)
		return;
	out.buffer = (char *)cau_buffer_bytes(buffer);
	if (cau_rpc_write_notification(&out, method, params, &error)) {
		cau_log(CAU_LOG_ERROR, identity->id, "notification_lost", "path=%s reason=\"%s\"",
		        error.path, error.reason);
		cau_buffer_release(buffer);
		return;
	}
	buffer->byte_count = out.bytes;
	identity->around->sink.notify(identity->around->sink.user, audience, buffer);
}
