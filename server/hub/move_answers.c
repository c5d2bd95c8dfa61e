// SPDX-License-Identifier: GPL-3.0-or-later
// What a courier is told.
#include <stdlib.h>
#include <string.h>

#include "hub/internal.h"

void cau_move_fail(const cau_reply *reply, cau_status status, int32_t code, const char *path,
                   const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, path, "%s", reason);
	cau_reply_fail(reply, &error, code);
}

void cau_move_answer(const cau_reply *reply, const void *result)
{
	cau_error error = {0};
	cau_outcome outcome = {0};
	if (!reply->answer) // nobody waits: its method is none, whose message would be another's
		return;
	char *text = cau_answer_text(reply->method, result, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(reply, &outcome);
	free(text);
}

void cau_move_decided(const cau_reply *reply, const cau_tombstone *moved)
{
	cau_wire_move_decision result = {.moved = true, .has_target = true, .has_proof = true};
	memcpy(result.target, moved->to.session, sizeof result.target);
	memcpy(result.proof, moved->proof, sizeof result.proof);
	cau_move_answer(reply, &result);
}

void cau_move_kept(const cau_reply *reply, const char *release)
{
	cau_wire_move_decision result = {.moved = false, .has_release = true};
	snprintf(result.release, sizeof result.release, "%s", release);
	cau_move_answer(reply, &result);
}
