// SPDX-License-Identifier: GPL-3.0-or-later
// One WebSocket connection, as the network thread sees it.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "buffer/buffer.h"
#include "cautery/rpc_errors.h"

struct lws;
typedef struct cau_network cau_network;

enum {
	CAU_ADDRESS_BYTES = 64,
	CAU_CLOSE_REASON_BYTES = 124,     // RFC 6455 allows 123 and this a zero
	CAU_CONTROL_BYTES_MAX = 16 << 20, // replies that wait for one connection; more closes it
};

typedef struct cau_connection {
	uint64_t id; // never used again
	cau_network *network;
	struct lws *wsi;
	struct cau_connection *previous, *next;
	void *peer; // the handler's own
	double opened_s, last_taken_s;
	bool served;           // hello was answered: the hello timeout is off
	bool first_frame_seen; // and it was masked
	int descriptor;
	char address[CAU_ADDRESS_BYTES]; // the peer's, as text; "" if nobody knows it

	// the message that is coming in
	unsigned char *message; // malloc'ed
	size_t message_bytes, message_capacity;
	// messages of the present second
	double rate_start_s;
	int64_t rate_count;

	// what goes out: replies first, then frames
	cau_buffer *control_first, *control_last;
	size_t control_bytes;
	int closing;     // a close code, 0 while open
	bool close_sent; // what still comes in is read and dropped until the peer has closed
	char closing_reason[CAU_CLOSE_REASON_BYTES];
} cau_connection;

// Queues a text message; takes the buffer. A connection whose replies pile up beyond
// CAU_CONTROL_BYTES_MAX is closed.
void cau_connection_send(cau_connection *connection, cau_buffer *buffer);
// Asks for next_frame to be called when the socket can take more.
void cau_connection_want_frame(cau_connection *connection);
// Sends what is queued, then closes. The first reason stands; NULL is the code's own.
void cau_connection_close(cau_connection *connection, cau_close_code code, const char *reason);
