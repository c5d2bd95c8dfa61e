// SPDX-License-Identifier: Apache-2.0
// Declarations for the files of the client library.
#pragma once

#include <libwebsockets.h>

#include "cautery/client.h"
#include "library/url.h"

enum {
	CAU_CLIENT_TEXT_MAX = 64 << 20,  // largest size of a text message from the server
	CAU_CLIENT_BINARY_MAX = 1 << 30, // largest size of a frame or chunk
	// largest interval between heartbeats, acknowledgements and requests for key frames
	CAU_CLIENT_TICK_US = 100000,
	CAU_CLIENT_CLOSE_WAIT_US = 1000000,
};

// ---- outbox ------------------------------------------------------------------------------------
// A queue of messages that wait to be written to the socket.

// Largest size of all queued messages. A message that would exceed this size is refused with
// CAU_LIMIT.
enum { CAU_OUTBOX_BYTES_MAX = 8 << 20 };

typedef struct cau_outbox_message {
	struct cau_outbox_message *next;
	bool binary;
	size_t byte_count;
	unsigned char bytes[]; // headroom for the WebSocket header, then the message
} cau_outbox_message;

typedef struct cau_outbox {
	cau_outbox_message *first, *last;
	size_t byte_count;
} cau_outbox;

// Appends a message, a copy of head followed by body. Errors: CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_outbox_add(cau_outbox *outbox, bool binary, const void *head, size_t head_bytes,
                          const void *body, size_t body_bytes, cau_error *error);
unsigned char *cau_outbox_bytes(cau_outbox_message *message); // the message after its headroom
cau_outbox_message *cau_outbox_take(cau_outbox *outbox);      // NULL if empty; the caller frees it
void cau_outbox_clear(cau_outbox *outbox);

// ---- loop and client ---------------------------------------------------------------------------
struct cau_loop {
	struct lws_context *context;
	lws_sorted_usec_list_t wake; // timer that ends a wait
};

// A request that has no answer yet.
typedef struct cau_client_pending {
	struct cau_client_pending *next;
	int64_t id;
	cau_method method;
	cau_client_answer *answer; // NULL if no caller waits any more
	void *user;
	bool resendable;
	bool again; // answered with `moved`, so it will be sent to the new daemon
	size_t byte_count;
	char text[];
} cau_client_pending;

typedef struct cau_client_slot {
	cau_client_stream stream; // visible to the caller
	cau_client *client;
	cau_wire_session_join wanted;
	void *storage; // memory of the decoder
	cau_frame_decoder *decoder;
	double gap_s;       // time since which a key frame is missing, or 0
	double key_asked_s; // time of the last request for a key frame
	uint64_t acknowledged;
	cau_client_answer *answer; // callback of the caller's join
	void *user;
} cau_client_slot;

// A file that arrives in chunks.
typedef struct cau_client_incoming {
	int64_t transfer; // 0 until the answer has come
	unsigned char *bytes;
	size_t byte_count, received;
	bool broken;
} cau_client_incoming;

// The message that is being received.
typedef struct cau_client_message {
	unsigned char *bytes;
	size_t byte_count, capacity;
} cau_client_message;

// How the client follows a session that has moved to another daemon.
typedef struct cau_client_follow {
	bool now; // the client is connecting to the session's new daemon
	int ways; // number of attempts that found the session not yet served by the new daemon
	double arrives_until_s;
	char kept_resume[65]; // resume token of the old daemon until the session is found, then ""
	// the id that the program knows, and the present id; "" if the session has not moved
	char from[CAU_NAME_BYTES], to[CAU_NAME_BYTES];
} cau_client_follow;

struct cau_client {
	cau_loop *loop;
	cau_client_def def; // its strings are in the arrays below
	char session[CAU_NAME_BYTES], label[CAU_NAME_BYTES], token[513], name[65], client_id[65];
	cau_url url;
	struct lws *wsi;
	cau_client_condition condition;
	bool closing; // this program closes the connection
	int close_code;
	char close_reason[128];
	cau_error trouble;
	cau_rpc_fault fault;
	cau_outbox outbox;
	cau_client_message message;
	cau_client_pending *first_pending, *last_pending;
	int64_t last_id, last_sequence;
	cau_wire_hello_result server;
	uint64_t connections;
	int attempts;    // number of attempts to connect since the last hello
	bool keep_alive; // see cau_client_keep_alive
	cau_client_follow follow;
	lws_sorted_usec_list_t tick, retry, deadline;
	cau_client_slot *slots[CAU_CLIENT_STREAMS_MAX];
	cau_client_incoming *incoming; // the file that is arriving, or NULL; only one at a time
};

// fleet.c
#define CAU_FLEET_PROTOCOL "cautery-fleet" // libwebsockets needs this name; it is never sent
int cau_fleet_on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t bytes);

// queues.c
// Closes the connection soon. cau_client_lost is called then.
void cau_socket_cut(cau_client *client);
cau_status cau_socket_send(cau_client *client, bool binary, const void *head, size_t head_bytes,
                           const void *body, size_t body_bytes, cau_error *error);
void cau_pending_add(cau_client *client, cau_client_pending *pending); // appends to the list
// Removes and returns the request with this id, for the caller to free. Returns NULL if there is
// none.
cau_client_pending *cau_pending_take(cau_client *client, int64_t id);

// connection.c
void cau_client_begin(cau_client *client);
void cau_client_forget_timers(cau_client *client);
void cau_client_beat(cau_client *client); // sends a heartbeat with this machine's clock
void cau_client_opened(cau_client *client);
void cau_client_not_opened(cau_client *client, struct lws *wsi, const char *in, size_t bytes);
void cau_client_lost(cau_client *client, const char *reason);
void cau_text_received(cau_client *client, const char *text, size_t bytes);

// wait.c
bool cau_client_wait_for(cau_client *client, const bool *done, double until_s);
// Waits for the answer to a request of `user`, `timeout_s` at most. Expensive requests (building,
// rewinding, files) may take longer while the server answers heartbeats.
cau_status cau_client_await(cau_client *client, cau_method method, const bool *done,
                            const void *user, cau_error *error);

// calls.c
void cau_calls_answered(cau_client *client, const cau_rpc_message *message);
// Fails all requests, or only those that cannot be sent again.
void cau_calls_lost(cau_client *client, bool all);
void cau_calls_resend(cau_client *client);
void cau_error_of_fault(const cau_rpc_fault *fault, cau_error *error);

// follow.c
// Returns the text with the session id replaced, allocated with malloc. Returns NULL if the text
// does not name `from`.
char *cau_follow_text(const char *from, const char *to, const char *text, size_t *bytes);
// Starts to follow a session. Returns false if this client does not follow it.
bool cau_follow(cau_client *client, const char *from, const char *to, const char *url);
void cau_follow_when_answered(cau_client *client);
// Call it when the daemon has answered about the session.
void cau_follow_found(cau_client *client);
// Keeps a request that was answered with `moved` to send it again. Returns false if the program
// must get the error.
bool cau_follow_answer(cau_client *client, cau_client_pending *pending, const cau_rpc_fault *fault);
bool cau_follow_join(cau_client *client, const char *session, const cau_rpc_fault *fault);
void cau_follow_change(cau_client *client, const cau_wire_session_changed *changed);

// streams.c, frames.c
void cau_streams_lost(cau_client *client);
void cau_streams_rejoin(cau_client *client);
void cau_streams_changed(cau_client *client, const cau_rpc_message *message);
void cau_streams_tick(cau_client *client);
void cau_frame_received(cau_client *client, const void *bytes, size_t byte_count);
void cau_slot_free(cau_client_slot *slot);

// transfer.c
void cau_chunk_received(cau_client *client, const void *bytes, size_t byte_count);
