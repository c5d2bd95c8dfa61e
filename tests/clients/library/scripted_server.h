// SPDX-License-Identifier: GPL-3.0-or-later
// A server for the tests of the client library. It is a real WebSocket server on loopback, with a
// thread of its own, and behaves as the test's script says. It uses the protocol's codecs. It has
// no session and computes nothing.
#pragma once

#include <stdatomic.h>

#include "cautery/frame_codec.h"
#include "cautery/rpc.h"

enum { SCRIPTED_VERTICES = 4, SCRIPTED_FACES = 2 };

typedef struct scripted_server scripted_server;
typedef struct scripted_peer scripted_peer;

// Called in the server's thread for every text message. Returns true if the script handled the
// message. If it returns false, the server handles it: it answers hello, heartbeat and
// session.join, accepts notices, and answers other requests with method_not_found.
typedef bool scripted_text(scripted_peer *peer, const cau_rpc_message *message, const char *text);
typedef void scripted_binary(scripted_peer *peer, const void *bytes, size_t byte_count);

typedef struct scripted_script {
	scripted_text *text;     // NULL for standard behaviour
	scripted_binary *binary; // NULL: binary messages are ignored
	void *user;              // pointer that scripted_user returns
} scripted_script;

scripted_server *scripted_start(const scripted_script *script);
void scripted_stop(scripted_server *server); // the script does not run any more after this call
const char *scripted_url(const scripted_server *server);

// ---- in the server's thread --------------------------------------------------------------------
void *scripted_user(const scripted_peer *peer);
int scripted_number(const scripted_peer *peer); // connections are numbered from 1
void scripted_result(scripted_peer *peer, const cau_rpc_message *request, cau_method method,
                     const void *result);
void scripted_refuse(scripted_peer *peer, const cau_rpc_message *request, int32_t code,
                     const char *status, const char *path, const char *reason);
void scripted_notify(scripted_peer *peer, cau_method method, const void *params);
void scripted_send(scripted_peer *peer, bool binary, const void *bytes, size_t byte_count);
void scripted_close(scripted_peer *peer, int code); // 0 cuts the connection without a close frame

// The standard stream is a square of two faces. Every frame moves vertex 0 to x = sequence mm.
void scripted_answer_join(scripted_peer *peer, const cau_rpc_message *request);
void scripted_send_topology(scripted_peer *peer);
void scripted_advance(scripted_peer *peer, bool send); // encodes one frame and sends it if `send`
void scripted_send_key(scripted_peer *peer);
