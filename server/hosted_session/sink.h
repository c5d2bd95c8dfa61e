// SPDX-License-Identifier: GPL-3.0-or-later
// What sessions send to the transports. A transport provides one sink. Any thread may call its
// functions. They must not block, and must not call back into a session.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "buffer/buffer.h"
#include "cautery/rpc.h"

typedef struct cau_hosted cau_hosted;

// The receivers of a notification. `id` is the number of the client or of the session, by kind.
typedef struct cau_audience {
	enum {
		CAU_AUDIENCE_CLIENT,    // one client
		CAU_AUDIENCE_SESSION,   // all clients that joined a stream of the session
		CAU_AUDIENCE_EVERYBODY, // all clients that said hello
	} kind;
	uint64_t id;
} cau_audience;

// Where to find a session that has moved to another daemon.
typedef struct cau_moved_to {
	char session[CAU_NAME_BYTES]; // the session's id on that daemon; "": it has not moved
	char url[256]; // address of that daemon; "": the client's present address leads to it
} cau_moved_to;

// The outcome of a request.
typedef struct cau_outcome {
	const cau_error *error;    // NULL: the request succeeded
	int32_t code;              // CAU_RPC_* code of the error; 0: the code of its status
	const cau_moved_to *moved; // for CAU_RPC_MOVED
	const char *text; // on success: the complete JSON-RPC answer; its id is the name of its method
	size_t text_bytes;
	cau_buffer *file;   // file of an export; the sink takes its own reference
	uint32_t transfer;  // number of the file in its chunks
	cau_hosted *joined; // session.join: the session whose stream the client has joined
	int32_t stream;
} cau_outcome;

// Where to send an answer. It is kept with the request and may be copied.
typedef struct cau_reply {
	void (*answer)(void *user, const struct cau_reply *reply, const cau_outcome *outcome);
	void *user;
	uint64_t connection;
	cau_rpc_id id;
	cau_method method;
} cau_reply;

typedef struct cau_sink {
	void *user;
	// Sends a finished notification. Takes ownership of the buffer.
	void (*notify)(void *user, cau_audience audience, cau_buffer *text);
	// Called when streams have new frames.
	void (*frames)(void *user);
	// Called after a slice of the session with this number: its tools may have moved. May be NULL.
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

// Answers that another daemon has the session.
void cau_reply_moved(const cau_reply *reply, const cau_moved_to *to);

// Sends the stored answer `text` to the client that asks again. A client's sequence number belongs
// to one method. If the stored answer is of another method, the client receives
// CAU_RPC_SEQUENCE_CONFLICT.
void cau_resend_answer(const cau_reply *reply, const char *text, size_t text_bytes);
