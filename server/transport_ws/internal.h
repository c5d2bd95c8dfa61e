// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share.
#pragma once

#include <libwebsockets.h>
#include <pthread.h>
#include <stdatomic.h>

#include "cautery/rpc.h"
#include "http/response.h"
#include "transport_ws/network.h"
#include "transport_ws/tls.h"

#define CAU_WS_PATH "/v1"

enum {
	HEADER_BYTES = 512,
	NOTSENT_LOWAT_BYTES = 16384, // see set_socket in connection.c
	// Writing replies is charged after the turn: this bounds what a turn can owe.
	CAU_TURN_REPLY_BYTES = 65536,
	CAU_CLOSE_FRAME_BYTES = 4 + CAU_CLOSE_REASON_BYTES,
	CAU_OUTSIDERS_MOST = 64,
};

// One whose request is still to come.
typedef struct cau_unread {
	struct lws *wsi; // NULL: none has this descriptor
	double since_s;
	double input_s; // when bytes were seen that this thread had yet to read; 0: never
	char address[CAU_ADDRESS_BYTES];
	char owner[CAU_ADDRESS_BYTES]; // see cau_address_owner
} cau_unread;

// What ended without hello, of one owner of addresses, since the last line of the log.
typedef struct cau_outsider {
	char owner[CAU_ADDRESS_BYTES]; // "": the row is free
	char reason[CAU_CLOSE_REASON_BYTES];
	uint64_t count;
	double told_s;
} cau_outsider;

struct cau_network {
	cau_network_def def;
	cau_tls *tls; // NULL: without
	struct lws_context *context;
	struct lws_vhost *vhost;
	lws_retry_bo_t validity;
	struct lws_protocols protocols[4];
	pthread_t thread;
	bool started;
	atomic_bool woken, ending;
	cau_close_code ending_code;
	double ending_until_s;
	double ran_s;                      // when this thread last came round
	double stopped_s, stopped_until_s; // it did not run from then on, see sent_after
	cau_unread *unread;                // by descriptor, see unread.c
	int unread_capacity;
	int input; // epoll descriptor, see input.c
	uint64_t last_id;
	cau_connection *connections; // open ones
	cau_connection *lingering;   // ending ones, which the handler has left
	cau_connection *waiting;     // those with something to read, see turns.c
	cau_shares shares;
	lws_sorted_usec_list_t turns;
	cau_network_counts counts;
	cau_outsider outsiders[CAU_OUTSIDERS_MOST];
	lws_sorted_usec_list_t sul;
};

// Checks an upgrade request. Status 0: it may go on.
cau_http_refusal cau_handshake_check(cau_network *network, struct lws *wsi);
// Host and Origin of any request. Status 0: they are fine.
cau_http_refusal cau_request_check(cau_network *network, struct lws *wsi);
// Copies a header; false if it is absent or too long.
bool cau_request_header(struct lws *wsi, enum lws_token_indexes token, char *text, size_t capacity);

// One per libwebsockets protocol.
int cau_http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                      size_t bytes);
int cau_ws_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t bytes);
int cau_input_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t bytes);

// ---- rounds.c
// The thread comes round: notes whether it did not for long.
void cau_network_comes_round(cau_network *network);
// A moment that what is read now was sent after, for all that this thread knows: `now_s`, unless
// the thread did not run for the deadline of a browser's driver. What it reads for one deadline
// from then on may have waited since it last ran.
double cau_network_sent_after_s(const cau_network *network, double now_s);

// ---- refusals.c
void cau_note_refusal(cau_network *network, struct lws *wsi, const cau_http_refusal *refusal);
void cau_refuse_request(struct lws *wsi, const cau_http_refusal *refusal);

// ---- unread.c
// Answers past the library, which is about to end the connection.
void cau_refuse_unread(cau_network *network, struct lws *wsi, bool large);
bool cau_unread_add(cau_network *network, struct lws *wsi); // false: no memory
void cau_unread_remove(cau_network *network, struct lws *wsi);
// The library logs this line of the connection that it serves.
void cau_unread_complaint(cau_network *network, const char *line);

// ---- strangers.c
// Who has an address, as text: of IPv6 the network of 64 bits, else the address itself.
void cau_address_owner(const char *address, char owner[CAU_ADDRESS_BYTES]);
// Closes the oldest connection whose request has not come, or that has said no hello, if there are
// too many of this one's owner or of all.
void cau_strangers_bound_unread(cau_network *network, const cau_unread *newest);
void cau_strangers_bound_silent(cau_network *network, const cau_connection *newest);
// Something else than hello has come of a connection: closes it where there are too many.
void cau_strangers_bound_talk(cau_connection *connection);

// ---- outsiders.c
// A connection of `owner` ended without hello.
void cau_outsiders_note(cau_network *network, const char *owner, const char *reason);
// Writes the lines that are due; several times a minute.
void cau_outsiders_tick(cau_network *network, double now_s);

// ---- input.c
bool cau_input_open(cau_network *network);
bool cau_input_begin(cau_connection *connection);
// Twice, from callbacks in which the socket can be written; false if the
// connection must end.
bool cau_input_take_over(cau_connection *connection);
void cau_input_end(cau_connection *connection);

// Whether epoll reports what comes for the connection.
bool cau_input_poll(cau_connection *connection, bool polled);

// There is something to read for the connection: it waits for a turn.
void cau_input_wait(cau_connection *connection);
void cau_input_forget(cau_connection *connection);

// ---- turns.c
// Some of its replies have been taken.
void cau_turns_resume(cau_connection *connection);

// ---- reading.c
// Reads for the connection until the thread's processor time is `until_s`. Returns whether more
// is there to be read at once.
bool cau_connection_read(cau_connection *connection, double until_s);

// ---- socket.c
// As recv() does: what is there, at most so many bytes; 0 behind the last one; -1 with EAGAIN.
ssize_t cau_connection_receive(cau_connection *connection, void *bytes, size_t most);
// Whether there is more than the socket tells of: the rest of a record of TLS.
bool cau_connection_has_more(const cau_connection *connection);
// Sends a few bytes past libwebsockets, or loses them.
void cau_connection_put(cau_connection *connection, const void *bytes, size_t count);
// Tells the peer that nothing follows.
void cau_connection_shut(cau_connection *connection);

// The last bytes of a connection that libwebsockets is about to end; what its peer still sends does
// not take them from it.
void cau_wsi_last_words(struct lws *wsi, const void *bytes, size_t count);

// ---- sending.c
void cau_connection_pong(cau_connection *connection, const void *payload, size_t bytes);

// ---- closing.c
void cau_connection_link(cau_connection **first, cau_connection *connection);
void cau_connection_unlink(cau_connection **first, cau_connection *connection);
// Tells the handler that the connection has ended, once.
void cau_connection_leave(cau_connection *connection);
// Its close frame has come; code 0: without one.
void cau_connection_closed_by_peer(cau_connection *connection, int code);
// It has shut its side of the socket, or is gone.
void cau_connection_ended_by_peer(cau_connection *connection);
void cau_connection_timer(cau_connection *connection);
// Goes on with the end when the socket can be written. Returns what the
// callback returns.
int cau_connection_write_close(cau_connection *connection);
// libwebsockets is about to end the connection.
void cau_connection_dropped(cau_connection *connection);
// Closes one that has not been heard of for long, or has said no hello in time.
void cau_connection_watch(cau_connection *connection, double now_s);

// Serves a plain HTTP request.
int cau_http_serve(cau_network *network, struct lws *wsi, cau_http_body *body, const char *path);

// Whether the connection's turn ends, and the next one waits, until its replies have been taken. A
// driver is read all the same: energy off must not wait for what its client does not read.
static inline bool cau_turns_blocked(const cau_connection *c)
{
	return c->output.bytes > CAU_TURN_REPLY_BYTES && !c->end.code &&
	       c->turn.share.standing < CAU_STANDING_DRIVER;
}

// Whether anything was read of it.
static inline bool cau_connection_has_spoken(const cau_connection *c)
{
	return c->input.heard_s > c->opened_s;
}

static inline cau_network *cau_network_of(struct lws *wsi)
{
	return lws_context_user(lws_get_context(wsi));
}
