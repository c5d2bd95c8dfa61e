// SPDX-License-Identifier: GPL-3.0-or-later
// The move.* methods: requests of a courier to the source daemon and to the target daemon.
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

// Submits a request of a courier. A move needs a token for all sessions; a token for some sessions
// is refused.
static void submit(cau_call *call, cau_move_asked *asked)
{
	cau_error error = {0};
	cau_reply reply = cau_call_reply(call);
	bool file = call->method->cost == CAU_COST_FILE && reply.answer;
	if (*call->peer->bounds.sessions) {
		free(asked->piece);
		cau_call_may_use(call, "");
		return;
	}
	if (cau_moves_ask(call->peer->service->moves, asked, &reply, &error))
		cau_call_fail(call, &error, 0);
	else
		call->peer->files_asked += file;
}

static void submit_ref(cau_call *call, cau_move_what what)
{
	cau_error error = {0};
	cau_wire_move_ref params = {0};
	cau_move_asked asked = {.what = what};
	if (cau_rpc_params(call->message, &params, &error)) {
		cau_call_fail(call, &error, 0);
		return;
	}
	memcpy(asked.session, params.session, sizeof asked.session);
	memcpy(asked.move, params.move, sizeof asked.move);
	submit(call, &asked);
}

void cau_call_move_begin(cau_call *call)
{
	cau_error error = {0};
	cau_wire_move_begin params = {0};
	cau_move_asked asked = {.what = CAU_MOVE_BEGIN};
	if (cau_rpc_params(call->message, &params, &error)) {
		cau_call_fail(call, &error, 0);
		return;
	}
	memcpy(asked.session, params.session, sizeof asked.session);
	memcpy(asked.label, params.label, sizeof asked.label);
	memcpy(asked.to.session, params.target, sizeof asked.to.session);
	snprintf(asked.to.url, sizeof asked.to.url, "%s", params.url);
	submit(call, &asked);
}

void cau_call_move_read(cau_call *call)
{
	submit_ref(call, CAU_MOVE_READ);
}

void cau_call_move_hold(cau_call *call)
{
	submit_ref(call, CAU_MOVE_HOLD);
}

void cau_call_move_cancel(cau_call *call)
{
	submit_ref(call, CAU_MOVE_CANCEL);
}

void cau_call_move_ready(cau_call *call)
{
	submit_ref(call, CAU_MOVE_READY);
}

void cau_call_move_list(cau_call *call)
{
	submit(call, &(cau_move_asked){.what = CAU_MOVE_LIST});
}

static void submit_key(cau_call *call, cau_move_asked *asked, const char *session, const char *move,
                       const char *key)
{
	snprintf(asked->session, sizeof asked->session, "%s", session);
	snprintf(asked->move, sizeof asked->move, "%s", move);
	snprintf(asked->key, sizeof asked->key, "%s", key);
	submit(call, asked);
}

void cau_call_move_commit(cau_call *call)
{
	cau_error error = {0};
	cau_wire_move_commit params = {0};
	cau_move_asked asked = {.what = CAU_MOVE_COMMIT};
	if (cau_rpc_params(call->message, &params, &error))
		cau_call_fail(call, &error, 0);
	else
		submit_key(call, &asked, params.session, params.move, params.receipt);
}

void cau_call_move_accept(cau_call *call)
{
	cau_error error = {0};
	cau_wire_move_accept params = {0};
	cau_move_asked asked = {.what = CAU_MOVE_ACCEPT};
	if (cau_rpc_params(call->message, &params, &error))
		cau_call_fail(call, &error, 0);
	else
		submit_key(call, &asked, params.session, params.move, params.proof);
}

void cau_call_move_forget(cau_call *call)
{
	cau_error error = {0};
	cau_wire_move_forget params = {0};
	cau_move_asked asked = {.what = CAU_MOVE_FORGET};
	cau_status status = cau_rpc_params(call->message, &params, &error);
	asked.source_lost = params.has_source_lost && params.source_lost;
	if (!status && !params.has_release && !asked.source_lost)
		status = cau_fail(&error, CAU_BAD_VALUE, "params.release",
		                  "missing: move.cancel of the source daemon returns the release");
	if (status)
		cau_call_fail(call, &error, 0);
	else
		submit_key(call, &asked, params.session, params.move,
		           params.has_release ? params.release : "");
}

// Passes the upload's bytes on with the request. The connection loses the upload.
void cau_call_move_receive(cau_call *call)
{
	cau_error error = {0};
	cau_wire_move_receive params = {0};
	cau_move_asked asked = {.what = CAU_MOVE_RECEIVE};
	cau_peer *peer = call->peer;
	cau_status status = cau_rpc_params(call->message, &params, &error);
	cau_upload *upload = status ? NULL : cau_uploads_find(&peer->uploads, params.upload);
	if (!status && (!upload || !upload->complete))
		status = cau_fail(&error, CAU_NOT_FOUND, "params.upload",
		                  "this connection has no complete upload named `%.48s`", params.upload);
	if (status) {
		cau_call_fail(call, &error, 0);
		return;
	}
	memcpy(asked.session, params.session, sizeof asked.session);
	memcpy(asked.move, params.move, sizeof asked.move);
	asked.piece = upload->bytes;
	asked.piece_bytes = upload->byte_count;
	upload->bytes = NULL;
	cau_uploads_drop(&peer->uploads, &peer->service->uploads, upload);
	submit(call, &asked);
}
