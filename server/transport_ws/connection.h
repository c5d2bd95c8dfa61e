// SPDX-License-Identifier: GPL-3.0-or-later
// One WebSocket connection, as the network thread uses it.
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
	CAU_CLOSE_REASON_BYTES = 124,     // RFC 6455 allows 123, plus a zero
	CAU_CONTROL_BYTES_MAX = 16 << 20, // a connection with more bytes of waiting replies is closed
};

// Who reads the socket; see input.c.
typedef enum cau_reading {
	CAU_READING_HELD, // nobody, while the handshake is answered
	CAU_READING_LIBRARY,
	CAU_READING_OURS,
	CAU_READING_ENDED,
} cau_reading;

// Incoming bytes; only the network thread uses this. input.c, reading.c.
typedef struct cau_connection_input {
	cau_reading reading;
	cau_frame_reader reader;
	double heard_s;      // time of the last received bytes
	bool polled;         // epoll reports input of this connection
	unsigned char *held; // bytes received in one turn and left for the next; NULL: no bytes
	size_t held_at, held_bytes;
	double empty_s;      // time when the socket was last known to be empty
	double sent_after_s; // the message at hand was sent after this time
	// Messages, control frames and short fragments of the present second:
	double rate_start_s;
	int64_t rate_count;
} cau_connection_input;

// The connection's turn among those that are read; only the network thread uses this. turns.c.
typedef struct cau_connection_turn {
	cau_share share;
	struct cau_connection *next; // next waiting connection
	bool waits;
} cau_connection_turn;

// Outgoing bytes, in this order: the answer to a ping, replies, frames. Only the network thread
// uses this. closing.c.
typedef struct cau_connection_output {
	bool pong_due;
	unsigned char pong[CAU_CONTROL_FRAME_BYTES];
	size_t pong_bytes;
	cau_buffer *first, *last; // waiting replies
	size_t bytes;             // bytes of the waiting replies
} cau_connection_output;

// How the connection ends; only the network thread uses this. closing.c.
typedef struct cau_connection_end {
	int code; // code of the close frame; 0: open
	char reason[CAU_CLOSE_REASON_BYTES];
	bool muted;      // nothing is written to the connection for a second
	bool close_sent; // received bytes are dropped until the peer has ended
	bool peer_ended; // the peer sends nothing more
	bool left;       // the handler was notified; the connection is in the list of lingering ones
	bool resetting;
} cau_connection_end;

// A connection. Only the network thread uses it.
typedef struct cau_connection {
	uint64_t id; // never used for another connection
	cau_network *network;
	struct lws *wsi;
	struct cau_connection *previous, *next;
	void *peer; // belongs to the handler
	double opened_s;
	bool served; // hello was accepted, so the hello timeout is off
	// the number of served connections was at its limit when this connection opened, so its client
	// may only resume
	bool unplaced;
	int descriptor;
	char address[CAU_ADDRESS_BYTES]; // the peer's address as text; "" if unknown
	char owner[CAU_ADDRESS_BYTES];   // owner of this address, from cau_address_owner
	cau_connection_input input;
	cau_connection_turn turn;
	cau_connection_output output;
	cau_connection_end end;
} cau_connection;

// True if one more connection may be served. `resumes`: the client returns to its tools, for which
// the limit is higher.
bool cau_connection_has_place(const cau_connection *connection, bool resumes);
// Notes that the connection's hello was accepted, with this role.
void cau_connection_serve(cau_connection *connection, cau_role role);
// Returns a time after which the message at hand was sent, as far as the network thread can tell.
// This is `now_s`, unless the thread was stopped or the message waited for its turn. Monotonic
// clock.
double cau_connection_sent_after_s(const cau_connection *connection, double now_s);
// Queues a text message and takes the buffer. Closes the connection if its waiting replies exceed
// CAU_CONTROL_BYTES_MAX.
void cau_connection_send(cau_connection *connection, cau_buffer *buffer);
// Asks for a call of next_frame when the socket can take more.
void cau_connection_want_frame(cau_connection *connection);
// Sends the queued bytes, then closes. The handler is notified a moment later, not from within this
// call. Only the reason of the first call is used; NULL means the code's own text.
void cau_connection_close(cau_connection *connection, cau_close_code code, const char *reason);
// Closes like cau_connection_close, but sends the queued bytes only after a second. Used for
// answers that would help someone who guesses tokens.
void cau_connection_close_late(cau_connection *connection, cau_close_code code);
