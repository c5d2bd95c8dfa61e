// SPDX-License-Identifier: GPL-3.0-or-later
// Requests for sessions that the hub does not have. A session that is only in the store, because it
// could not be resumed, is destroyed on request. All other requests are refused.
#include <stdlib.h>
#include <string.h>

#include "hub/internal.h"

void cau_clerk_answer_missing(cau_hub *hub, const cau_reply *reply, const char *id)
{
	cau_error error = {0};
	cau_moved_to to;
	if (cau_hub_moved(hub, id, &to)) {
		cau_reply_moved(reply, &to);
		return;
	}
	cau_fail(&error, CAU_NOT_FOUND, "params.session", "no session `%.48s` on this daemon", id);
	cau_reply_fail(reply, &error, CAU_RPC_NOT_HERE);
}

typedef struct discarding {
	cau_hub *hub;
	cau_reply reply;
	char id[CAU_NAME_BYTES];
	char *text; // the answer
	size_t text_bytes;
} discarding;

static void finish(discarding *what)
{
	if (what)
		free(what->text);
	free(what);
}

// Called on the store's thread with the outcome of the commit that removes the session.
static void committed(void *user, cau_status status, const char *reason)
{
	discarding *what = user;
	cau_error error = {0};
	cau_outcome outcome = {.text = what->text, .text_bytes = what->text_bytes};
	if (!status) {
		cau_log(CAU_LOG_INFO, what->id, "destroyed",
		        "reason=\"the session could not be started from the store\"");
		cau_reply_answer(&what->reply, &outcome);
	} else if (status == CAU_NOT_FOUND) {
		cau_clerk_answer_missing(what->hub, &what->reply, what->id);
	} else {
		cau_fail(&error, status, "", "%.200s", reason);
		cau_reply_fail(&what->reply, &error, cau_hosted_commit_code(status));
	}
	finish(what);
}

static discarding *begin(cau_hub *hub, const cau_creation *asked, cau_error *error)
{
	cau_wire_nothing result = {0};
	discarding *what = calloc(1, sizeof *what);
	if (!what) {
		cau_fail(error, CAU_NO_MEMORY, "", "no memory to destroy it");
		return NULL;
	}
	what->hub = hub;
	what->reply = asked->reply;
	memcpy(what->id, asked->name, sizeof what->id);
	what->text = cau_answer_text(asked->reply.method, &result, &what->text_bytes, error);
	if (what->text)
		return what;
	finish(what);
	return NULL;
}

static cau_status submit(cau_store *store, const cau_creation *asked, discarding *what,
                         cau_error *error)
{
	cau_store_answer row = {.client = asked->asker.client_id,
	                        .sequence = (uint64_t)asked->client_sequence,
	                        .result = {what->text, what->text_bytes}};
	cau_store_batch *batch = cau_store_batch_create();
	if (!batch)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory to destroy it");
	cau_status status = cau_store_delete_session(batch, what->id, error);
	if (!status && asked->client_sequence)
		status = cau_store_put_answer(batch, &row, error);
	if (!status)
		status = cau_store_submit(store, batch, committed, what, error);
	if (status)
		cau_store_batch_destroy(batch);
	return status;
}

void cau_clerk_discard(cau_hub *hub, const cau_creation *asked, bool arrives)
{
	cau_error error = {0};
	if (arrives) {
		cau_fail(&error, CAU_BAD_STATE, "params.session",
		         "the session is moving here from another daemon: finish it with `cautery move`");
		cau_reply_fail(&asked->reply, &error, 0);
		return;
	}
	discarding *what = begin(hub, asked, &error);
	if (what && !submit(hub->def.store, asked, what, &error))
		return;
	finish(what);
	cau_reply_fail(&asked->reply, &error, cau_hosted_commit_code(error.status));
}
