// SPDX-License-Identifier: GPL-3.0-or-later
// A server for the client library's tests: a real WebSocket on loopback, in a thread of its own,
// that says what the test's script tells it to. Written with the protocol's codecs; it holds no
// session and steps nothing.
#pragma once

#include <stdatomic.h>

#include "cautery/frame_codec.h"
#include "cautery/rpc.h"

enum { SCRIPTED_VERTICES = 4, SCRIPTED_FACES = 2 };

typedef struct scripted_server scripted_server;
typedef struct scripted_peer scripted_peer;

// Called in the server's thread for every text message. True: it was dealt with; false: the server
// does what a plain one would (hello, heartbeat and session.join are answered, notices are taken,
// other requests get method_not_found).
typedef bool scripted_text(scripted_peer *peer, const cau_rpc_message *message, const char *text);
typedef void scripted_binary(scripted_peer *peer, const void *bytes, size_t byte_count);

typedef struct scripted_script {
	scripted_text *text;     // NULL: plain
	scripted_binary *binary; // NULL: ignored
	void *user;              // see scripted_user
} scripted_script;

scripted_server *scripted_start(const scripted_script *script);
void scripted_stop(scripted_server *server); // after it nothing of the script runs any more
const char *scripted_url(const scripted_server *server);

// ---- in the server's thread --------------------------------------------------------------------
void *scripted_user(const scripted_peer *peer);
int scripted_number(const scripted_peer *peer); // connections are counted from 1
void scripted_result(scripted_peer *peer, const cau_rpc_message *request, cau_method method,
                     const void *result);
void scripted_refuse(scripted_peer *peer, const cau_rpc_message *request, int32_t code,
                     const char *status, const char *path, const char *reason);
void scripted_notify(scripted_peer *peer, cau_method method, const void *params);
void scripted_send(scripted_peer *peer, bool binary, const void *bytes, size_t byte_count);
void scripted_close(scripted_peer *peer, int code); // 0: cuts the connection without a word

// The plain stream: a square of two faces. Every frame moves vertex 0 to x = sequence mm.
void scripted_answer_join(scripted_peer *peer, const cau_rpc_message *request);
void scripted_send_topology(scripted_peer *peer);
void scripted_advance(scripted_peer *peer, bool send); // one frame: encoded, and perhaps sent
void scripted_send_key(scripted_peer *peer);
