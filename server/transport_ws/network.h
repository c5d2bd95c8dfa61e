// SPDX-License-Identifier: GPL-3.0-or-later
// The network thread: HTTP and WebSocket on one port. Only the functions that say so may be called
// from other threads. Everything else in transport_ws runs on the network thread.
#pragma once

#include "auth/auth.h"
#include "cautery/status.h"
#include "config/config.h"
#include "http/static_files.h"
#include "transport_ws/connection.h"

typedef struct cau_network cau_network;

// A page that the handler makes for a request.
typedef struct cau_page {
	const char *path;         // path of the request
	const char *accept;       // Accept header of the request; "" if none
	unsigned status;          // HTTP status of the answer; the members below are the answer too
	const char *content_type; // borrowed static text
	char *body;               // malloc'ed; NULL if memory ran out
	size_t bytes;
} cau_page;

// The functions that serve requests, called on the network thread.
typedef struct cau_network_handler {
	void *user;
	// Called after the handshake, before hello. `session` is from the URL, or "". Returns false to
	// refuse.
	bool (*opened)(void *user, cau_connection *connection, const char *session);
	void (*text)(void *user, cau_connection *connection, const char *text, size_t bytes);
	void (*binary)(void *user, cau_connection *connection, const void *bytes, size_t byte_count);
	void (*closed)(void *user, cau_connection *connection);
	// Returns the next frame for this connection, or NULL. The caller releases the frame.
	cau_buffer *(*next_frame)(void *user, cau_connection *connection);
	void (*woken)(void *user); // called after cau_network_wake
	// called about every 100 ms while there are connections
	void (*tick)(void *user);
	void (*page)(void *user, cau_page *page); // makes /healthz, /readyz, /metrics, /api/sessions
} cau_network_handler;

typedef struct cau_network_def {
	cau_config *config; // borrowed; `port` is set to the real port
	const cau_auth *auth;
	const cau_static_files *files;  // the viewer's files
	const cau_static_files *manual; // served under /manual/; NULL: no manual is installed
	cau_network_handler handler;
} cau_network_def;

// Makes a network that listens at once and serves after cau_network_start. Returns CAU_IO if the
// port is taken.
cau_status cau_network_create(cau_network **network, const cau_network_def *def, cau_error *error);
// Starts the thread.
cau_status cau_network_start(cau_network *network, cau_error *error);
// Makes the network thread call `woken` soon. Any thread may call it.
void cau_network_wake(cau_network *network);
// Closes every connection with the code, waits at most `seconds` for this, then ends the thread.
// Call it from the thread that created the network.
void cau_network_stop(cau_network *network, cau_close_code code, double seconds);
// Reads certificate and key again, if TLS is in use. On failure they stay as they were, and the
// error says why. Existing connections stay. Any thread may call it.
cau_status cau_network_reload_tls(cau_network *network, cau_error *error);
void cau_network_destroy(cau_network *network); // `network` may be NULL

// Returns the first open connection; the connections are in no order. Network thread only.
cau_connection *cau_network_first(cau_network *network);
// Returns the open connection with this id, or NULL. Network thread only.
cau_connection *cau_network_find(cau_network *network, uint64_t id);

typedef struct cau_network_counts {
	uint64_t served, strangers_closed;
	uint64_t connections, accepted, refused_handshakes, closed_slow, closed_errors;
	uint64_t refused_tokens; // pages refused for a missing or wrong token
	uint64_t messages_in, bytes_in, messages_out, bytes_out, frames_out;
} cau_network_counts;
cau_network_counts cau_network_count(cau_network *network); // network thread only
