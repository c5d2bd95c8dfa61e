// SPDX-License-Identifier: GPL-3.0-or-later
// What sessions say to the transports. A transport gives one sink; every function may be called
// from any thread, must not block, and must not call back into a session.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "buffer/buffer.h"
#include "cautery/rpc.h"

typedef struct cau_hosted cau_hosted;

// Who is told. `id`: of the connection, the client or the session, by kind.
typedef struct cau_audience {
	enum {
		CAU_AUDIENCE_CLIENT,    // one client, by its number
		CAU_AUDIENCE_SESSION,   // everybody who joined a session's stream, by its number
		CAU_AUDIENCE_EVERYBODY, // everybody who said hello
	} kind;
	uint64_t id;
} cau_audience;

// Where a session is that has moved to another daemon.
typedef struct cau_moved_to {
	char session[CAU_NAME_BYTES]; // its id there; "": nowhere
	char url[256];                // of that daemon; "": the same address leads there
} cau_moved_to;

// What became of a request.
typedef struct cau_outcome {
	const cau_error *error;    // NULL: done
	int32_t code;              // of the error: CAU_RPC_*; 0: the status's own
	const cau_moved_to *moved; // of CAU_RPC_MOVED
	const char *text;          // done: the whole JSON-RPC answer; its id is its method's name
	size_t text_bytes;
	cau_buffer *file;   // of an export; shared, the sink takes its own reference
	uint32_t transfer;  // the file's number in chunks
	cau_hosted *joined; // session.join: the stream that the asker now has
	int32_t stream;
} cau_outcome;

// Whom to answer, kept with the request; copied freely.
typedef struct cau_reply {
	void (*answer)(void *user, const struct cau_reply *reply, const cau_outcome *outcome);
	void *user;
	uint64_t connection;
	cau_rpc_id id;
	cau_method method;
} cau_reply;

typedef struct cau_sink {
	void *user;
	// A notification, ready to send; the sink takes the buffer.
	void (*notify)(void *user, cau_audience audience, cau_buffer *text);
	// Streams have new frames.
	void (*frames)(void *user);
	// A slice of the session with this number is over: its tools may be elsewhere. May be NULL.
	void (*sliced)(void *user, uint32_t session);
} cau_sink;

static inline void cau_reply_answer(const cau_reply *reply, const cau_outcome *outcome)
{
	if (reply->answer)
		reply->answer(reply->user, reply, outcome);
}

static inline void cau_reply_fail(const cau_reply *reply, const cau_error *error, int32_t code)
{
	cau_outcome outcome = {.error = error, .code = code};
	cau_reply_answer(reply, &outcome);
}

// Tells who asked that another daemon has the session.
void cau_reply_moved(const cau_reply *reply, const cau_moved_to *to);
