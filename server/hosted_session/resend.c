// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/resend.h"

#include <string.h>

// Reads the method's name from the answer's id. The name is empty if an older version stored the
// answer without it.
static void read_method(const char *text, size_t bytes, char name[CAU_RPC_ID_BYTES])
{
	static const char before[] = "{\"jsonrpc\":\"2.0\",\"id\":\"";
	size_t length = 0, skipped = sizeof before - 1;
	if (bytes > skipped && memcmp(text, before, skipped) == 0) {
		const char *end = memchr(text + skipped, '"', bytes - skipped);
		length = end ? (size_t)(end - text) - skipped : 0;
		if (length >= CAU_RPC_ID_BYTES)
			length = 0;
		memcpy(name, text + skipped, length);
	}
	name[length] = 0;
}

void cau_resend_answer(const cau_reply *reply, const char *text, size_t text_bytes)
{
	char method[CAU_RPC_ID_BYTES];
	cau_outcome outcome = {.text = text, .text_bytes = text_bytes};
	read_method(text, text_bytes, method);
	if (!*method || strcmp(method, cau_method_describe(reply->method)->name) == 0) {
		cau_reply_answer(reply, &outcome);
		return;
	}
	cau_error error = {0};
	cau_fail(&error, CAU_ALREADY_EXISTS, "params.client_sequence",
	         "this number belongs to a request `%s`", method);
	cau_reply_fail(reply, &error, CAU_RPC_SEQUENCE_CONFLICT);
}
