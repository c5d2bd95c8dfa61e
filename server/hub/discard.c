// SPDX-License-Identifier: GPL-3.0-or-later
// Destroys a session that is in the store only: one that could not be brought up.
#include <stdlib.h>
#include <string.h>

#include "hub/internal.h"

enum { ANSWER_BYTES = 512 }; // of a result without fields

typedef struct discarding {
	cau_reply reply;
	char id[CAU_NAME_BYTES], text[ANSWER_BYTES];
	size_t text_bytes;
} discarding;

static void fail(const discarding *what, cau_status status, const char *reason)
{
	cau_error error = {0};
	if (status == CAU_NOT_FOUND) {
		cau_fail(&error, status, "params.session", "this daemon does not have `%.48s`", what->id);
		cau_reply_fail(&what->reply, &error, CAU_RPC_NOT_HERE);
	} else {
		cau_fail(&error, status, "", "%.200s", reason);
		cau_reply_fail(&what->reply, &error, cau_hosted_commit_code(status));
	}
}

// On the store's thread.
static void committed(void *user, cau_status status, const char *reason)
{
	discarding *what = user;
	cau_outcome outcome = {.text = what->text, .text_bytes = what->text_bytes};
	if (status) {
		fail(what, status, reason);
	} else {
		cau_log(CAU_LOG_INFO, what->id, "destroyed", "reason=\"it had not been brought up\"");
		cau_reply_answer(&what->reply, &outcome);
	}
	free(what);
}

static cau_status write_answer(discarding *what, cau_error *error)
{
	cau_wire_nothing result = {0};
	cau_rpc_buffer out = {what->text, sizeof what->text, 0};
	cau_rpc_id id = {.kind = CAU_RPC_ID_TEXT};
	snprintf(id.text, sizeof id.text, "%s", cau_method_describe(what->reply.method)->name);
	cau_status status = cau_rpc_write_result(&out, &id, what->reply.method, &result, error);
	what->text_bytes = out.bytes;
	return status;
}

static cau_status fill(cau_store_batch *batch, const cau_creation *asked, const discarding *what,
                       cau_error *error)
{
	cau_store_answer row = {.client = asked->asker.client_id,
	                        .sequence = (uint64_t)asked->client_sequence,
	                        .result = {what->text, what->text_bytes}};
	cau_status status = cau_store_delete_session(batch, what->id, error);
	if (!status && asked->client_sequence)
		status = cau_store_put_answer(batch, &row, error);
	return status;
}

void cau_clerk_discard(cau_hub *hub, const cau_creation *asked)
{
	cau_error error = {0};
	discarding *what = calloc(1, sizeof *what);
	cau_store_batch *batch = cau_store_batch_create();
	cau_status status = CAU_NO_MEMORY;
	if (what && batch) {
		what->reply = asked->reply;
		memcpy(what->id, asked->name, sizeof what->id);
		status = write_answer(what, &error);
		if (!status)
			status = fill(batch, asked, what, &error);
		if (!status)
			status = cau_store_submit(hub->def.store, batch, committed, what, &error);
	}
	if (!status)
		return;
	cau_store_batch_destroy(batch);
	free(what);
	error.status = status;
	cau_reply_fail(&asked->reply, &error, cau_hosted_commit_code(status));
}
