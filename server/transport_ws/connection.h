// SPDX-License-Identifier: GPL-3.0-or-later
// One WebSocket connection, as the network thread sees it.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "buffer/buffer.h"
#include "cautery/rpc_errors.h"
#include "transport_ws/frame_reader.h"
#include "transport_ws/shares.h"

struct lws;
typedef struct cau_network cau_network;

#define CAU_NO_PLACE "too many connections (setting max_connections)"

enum {
	CAU_ADDRESS_BYTES = 64,
	CAU_CLOSE_REASON_BYTES = 124,     // RFC 6455 allows 123 and this a zero
	CAU_CONTROL_BYTES_MAX = 16 << 20, // replies that wait for one connection; more closes it
};

// Who reads the socket, see input.c.
typedef enum cau_reading {
	CAU_READING_HELD, // nobody, while the handshake is answered
	CAU_READING_LIBRARY,
	CAU_READING_OURS,
	CAU_READING_ENDED,
} cau_reading;

// Bytes that come in; the network thread's. input.c, reading.c.
typedef struct cau_connection_input {
	cau_reading reading;
	cau_frame_reader reader;
	double heard_s;      // when something came last
	bool polled;         // epoll reports what comes
	unsigned char *held; // received in a turn, and left for the next one; NULL: nothing
	size_t held_at, held_bytes;
	double empty_s;      // when its socket was known to be empty last
	double sent_after_s; // what is handled now was sent after this moment
	// messages, control frames and short fragments of the present second
	double rate_start_s;
	int64_t rate_count;
} cau_connection_input;

// Its place among the connections that are read; the network thread's. turns.c.
typedef struct cau_connection_turn {
	cau_share share;
	struct cau_connection *next; // that waits
	bool waits;
} cau_connection_turn;

// An answer to a ping, then replies, then frames go out; the network thread's. sending.c.
typedef struct cau_connection_output {
	bool pong_due;
	unsigned char pong[CAU_CONTROL_FRAME_BYTES];
	size_t pong_bytes;
	cau_buffer *first, *last; // replies
	size_t bytes;             // of replies
} cau_connection_output;

// The end of the connection; the network thread's. closing.c.
typedef struct cau_connection_end {
	int code; // of the close frame; 0: open
	char reason[CAU_CLOSE_REASON_BYTES];
	bool muted;      // nothing is written to it for a second
	bool close_sent; // bytes that still come are dropped until the peer has ended
	bool peer_ended; // it sends no more
	bool left;       // the handler was notified; the connection is among the lingering ones
	bool resetting;
} cau_connection_end;

// All of it is the network thread's.
typedef struct cau_connection {
	uint64_t id; // never used again
	cau_network *network;
	struct lws *wsi;
	struct cau_connection *previous, *next;
	void *peer; // the handler's own
	double opened_s;
	bool served;   // hello was accepted: the hello timeout is off
	bool unplaced; // as many as may be were served when it came: it may only resume
	int descriptor;
	char address[CAU_ADDRESS_BYTES]; // the peer's, as text; "": not known
	char owner[CAU_ADDRESS_BYTES];   // owner of this address: cau_address_owner
	cau_connection_input input;
	cau_connection_turn turn;
	cau_connection_output output;
	cau_connection_end end;
} cau_connection;

// Whether one more connection may be served; `resumes`: one that comes back to its tools.
bool cau_connection_has_place(const cau_connection *connection, bool resumes);
// Its hello was accepted, with this role.
void cau_connection_serve(cau_connection *connection, cau_role role);
// A moment that the message at hand was sent after, for all that the network thread knows. It is
// `now_s`, unless the thread was stopped or the message waited for its turn. Monotonic clock.
double cau_connection_sent_after_s(const cau_connection *connection, double now_s);
// Queues a text message; takes the buffer. A connection whose replies pile up
// beyond CAU_CONTROL_BYTES_MAX is closed.
void cau_connection_send(cau_connection *connection, cau_buffer *buffer);
// Asks for next_frame to be called when the socket can take more.
void cau_connection_want_frame(cau_connection *connection);
// Sends what is queued, then closes; the handler hears of the end a moment
// later, not from within. The first reason stands; NULL is the code's own.
void cau_connection_close(cau_connection *connection, cau_close_code code, const char *reason);
// The same, but all that is queued waits for a second: for answers that tell whoever guesses.
void cau_connection_close_late(cau_connection *connection, cau_close_code code);
