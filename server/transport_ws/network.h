// SPDX-License-Identifier: GPL-3.0-or-later
// The network thread: HTTP and WebSocket on one port. Only cau_network_wake may be called from
// other threads; everything else of this room runs on the network thread.
#pragma once

#include "auth/auth.h"
#include "cautery/status.h"
#include "config/config.h"
#include "http/static_files.h"
#include "transport_ws/connection.h"

typedef struct cau_network cau_network;

// A page that is made when it is asked for.
typedef struct cau_page {
	const char *path;         // of the request, like `accept`
	const char *accept;       // its Accept header; "": none
	unsigned status;          // the rest is the answer: HTTP's status,
	const char *content_type; // static
	char *body;               // malloc'ed, NULL if memory ran out
	size_t bytes;
} cau_page;

// What serves the requests, called on the network thread.
typedef struct cau_network_handler {
	void *user;
	// The handshake passed; hello is still to come. `session` is the URL's, or "". False: refused.
	bool (*opened)(void *user, cau_connection *connection, const char *session);
	void (*text)(void *user, cau_connection *connection, const char *text, size_t bytes);
	void (*binary)(void *user, cau_connection *connection, const void *bytes, size_t byte_count);
	void (*closed)(void *user, cau_connection *connection);
	// The next frame that this connection should get now, or NULL; the caller releases it.
	cau_buffer *(*next_frame)(void *user, cau_connection *connection);
	void (*woken)(void *user);                // after cau_network_wake
	void (*tick)(void *user);                 // about every 100 ms while there are connections
	void (*page)(void *user, cau_page *page); // /healthz, /readyz, /metrics, /api/sessions
} cau_network_handler;

typedef struct cau_network_def {
	cau_config *config; // borrowed; its port becomes the real one
	const cau_auth *auth;
	const cau_static_files *files;  // of the viewer
	const cau_static_files *manual; // served under /manual/; NULL: none is installed
	cau_network_handler handler;
} cau_network_def;

// Listens at once; serves from cau_network_start on. CAU_IO if the port is taken.
cau_status cau_network_create(cau_network **network, const cau_network_def *def, cau_error *error);
// Starts the thread.
cau_status cau_network_start(cau_network *network, cau_error *error);
// Calls `woken` soon on the network thread. From any thread.
void cau_network_wake(cau_network *network);
// Closes every connection with the code, waits at most `seconds` for that, then ends the
// thread. From the thread that created it.
void cau_network_stop(cau_network *network, cau_close_code code, double seconds);
// Reads certificate and key anew, if there are any; on failure they stay as they were, and the
// error says why. Nobody is disconnected. Any thread.
cau_status cau_network_reload_tls(cau_network *network, cau_error *error);
void cau_network_destroy(cau_network *network); // takes NULL

// Every open connection, in no order; on the network thread.
cau_connection *cau_network_first(cau_network *network);
// An open connection by id, or NULL; on the network thread.
cau_connection *cau_network_find(cau_network *network, uint64_t id);

typedef struct cau_network_counts {
	uint64_t served, strangers_closed;
	uint64_t connections, accepted, refused_handshakes, closed_slow, closed_errors;
	uint64_t refused_tokens; // of pages
	uint64_t messages_in, bytes_in, messages_out, bytes_out, frames_out;
} cau_network_counts;
cau_network_counts cau_network_count(cau_network *network); // on the network thread
