// SPDX-License-Identifier: GPL-3.0-or-later
// Shared declarations of transport_ws.
#pragma once

#include <libwebsockets.h>
#include <openssl/ssl.h>
#include <pthread.h>
#include <stdatomic.h>

#include "cautery/rpc.h"
#include "http/response.h"
#include "transport_ws/network.h"

#define CAU_WS_PATH "/v1"

enum {
	HEADER_BYTES = 512,
	NOTSENT_LOWAT_BYTES = 16384, // see set_socket in connection.c
	// Limit on the bytes of waiting replies within a turn. Writing replies is charged after the
	// turn, so this limit bounds the time that a turn can use beyond its share.
	CAU_TURN_REPLY_BYTES = 65536,
	CAU_CLOSE_FRAME_BYTES = 4 + CAU_CLOSE_REASON_BYTES,
	CAU_OUTSIDERS_MOST = 64,
};

typedef struct cau_tls cau_tls;

// A connection whose request has not come yet.
typedef struct cau_unread {
	struct lws *wsi; // NULL if no connection has this descriptor
	double since_s;
	double input_s; // time when bytes were seen that this thread had not read yet; 0: never
	char address[CAU_ADDRESS_BYTES];
	char owner[CAU_ADDRESS_BYTES]; // from cau_address_owner
} cau_unread;

// Connections of one owner of addresses that ended without hello since the last log line.
typedef struct cau_outsider {
	char owner[CAU_ADDRESS_BYTES]; // "" if this entry is free
	char reason[CAU_CLOSE_REASON_BYTES];
	uint64_t count;
	double told_s;
} cau_outsider;

struct cau_network {
	cau_network_def def;
	cau_tls *tls; // NULL without TLS
	struct lws_context *context;
	struct lws_vhost *vhost;
	lws_retry_bo_t validity;
	struct lws_protocols protocols[4];
	pthread_t thread;
	bool started;
	atomic_bool woken, ending;
	cau_close_code ending_code;
	double ending_until_s;
	double ran_s; // time when this thread last ran its loop
	// the thread did not run between these times, see cau_network_sent_after_s
	double stopped_s, stopped_until_s;
	cau_unread *unread; // indexed by descriptor, see unread.c
	int unread_capacity;
	int input; // epoll descriptor, see input.c
	uint64_t last_id;
	cau_connection *connections; // open connections
	cau_connection *lingering;   // ending connections; the handler has been notified
	cau_connection *waiting;     // connections with input, see turns.c
	cau_shares shares;
	lws_sorted_usec_list_t turns;
	cau_network_counts counts;
	cau_outsider outsiders[CAU_OUTSIDERS_MOST];
	lws_sorted_usec_list_t sul;
};

// Checks an upgrade request. Status 0 means that it is accepted.
cau_http_refusal cau_handshake_check(cau_network *network, struct lws *wsi);
// Checks Host and Origin of any request. Status 0 means that they are accepted.
cau_http_refusal cau_request_check(cau_network *network, struct lws *wsi);
// Copies a header. Returns false if the header is absent or too long.
bool cau_request_header(struct lws *wsi, enum lws_token_indexes token, char *text, size_t capacity);

// The callbacks of the three libwebsockets protocols.
int cau_http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                      size_t bytes);
int cau_ws_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t bytes);
int cau_input_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t bytes);

// Called in each pass of the loop. Notes it if the thread did not run for a long time.
void cau_network_comes_round(cau_network *network);
// Returns a time after which the bytes read now were sent, as far as this thread can tell. This is
// `now_s`, unless the thread did not run for the deadline of a browser's driver. After such a stop,
// bytes read within one deadline may have waited since the thread last ran.
double cau_network_sent_after_s(const cau_network *network, double now_s);

// ---- handshake.c: refusals
void cau_note_refusal(cau_network *network, struct lws *wsi, const cau_http_refusal *refusal);
void cau_refuse_request(struct lws *wsi, const cau_http_refusal *refusal);

// ---- tls.c: certificate and key
// A new pair is read, checked as a whole, and then replaces the old one in one step. Later
// handshakes use the new pair; existing connections keep theirs.

// Reads the pair that the settings name; *tls is NULL if the settings name no pair. Errors (path
// tls_certificate or tls_key, and the file in `file`): CAU_IO: the file cannot be read;
// CAU_BAD_SYNTAX: the file contains no certificate or key, or a key with a passphrase;
// CAU_BAD_VALUE: the key does not belong to the certificate, or other users may read the key, or
// the certificate has expired.
cau_status cau_tls_create(cau_tls **tls, const cau_config *config, cau_error *error);
void cau_tls_destroy(cau_tls *tls); // `tls` may be NULL

// Reads the pair again. On failure the pair stays as it was. Any thread may call it.
cau_status cau_tls_reload(cau_tls *tls, const cau_config *config, cau_error *error);

// Sets up a context for TLS 1.2 and 1.3 as in Mozilla's intermediate profile. Each handshake uses
// the pair of that moment.
void cau_tls_configure(cau_tls *tls, SSL_CTX *context);
// The ciphers of TLS 1.2, for libwebsockets.
extern const char cau_tls_ciphers[];

// ---- unread.c
// Refuses a request that the library is about to drop, without using the library.
void cau_refuse_unread(cau_network *network, struct lws *wsi, bool large);
bool cau_unread_add(cau_network *network, struct lws *wsi); // false: no memory
void cau_unread_remove(cau_network *network, struct lws *wsi);
// Called with each log line of the library, about the connection that the library serves now.
void cau_unread_complaint(cau_network *network, const char *line);

// ---- strangers.c
// Finds the owner of an address, as text: the network of 64 bits of an IPv6 address, else the
// address itself.
void cau_address_owner(const char *address, char owner[CAU_ADDRESS_BYTES]);
// Each closes the oldest connection if there are too many, either of the newest connection's owner
// or in all. The first counts connections whose request has not come, the second those without
// hello.
void cau_strangers_bound_unread(cau_network *network, const cau_unread *newest);
void cau_strangers_bound_silent(cau_network *network, const cau_connection *newest);
// Called when a connection sends a message other than hello. Closes the connection if too many
// connections without hello exist.
void cau_strangers_bound_talk(cau_connection *connection);

// ---- closing.c: connections that end without hello
// Counts a connection of `owner` that ended without hello.
void cau_outsiders_note(cau_network *network, const char *owner, const char *reason);
// Writes the log lines that are due. Call it several times a minute.
void cau_outsiders_tick(cau_network *network, double now_s);

// ---- input.c
bool cau_input_open(cau_network *network);
bool cau_input_begin(cau_connection *connection);
// Takes a step of the takeover. Called twice, from callbacks in which the socket can be written.
// Returns false if the connection must end.
bool cau_input_take_over(cau_connection *connection);
void cau_input_end(cau_connection *connection);

// Turns epoll reports of the connection's input on or off. Returns false on failure.
bool cau_input_poll(cau_connection *connection, bool polled);

// Adds the connection, which has input, to those that wait for a turn.
void cau_input_wait(cau_connection *connection);
void cau_input_forget(cau_connection *connection);

// ---- turns.c
// Called after some of the connection's replies were written.
void cau_turns_resume(cau_connection *connection);

// ---- reading.c
// Reads from the connection until the thread's processor time is `until_s`. Returns true if more
// can be read at once.
bool cau_connection_read(cau_connection *connection, double until_s);

// ---- socket.c
// Receives at most `most` bytes like recv(): 0 after the last byte; -1 with EAGAIN if there are
// none now.
ssize_t cau_connection_receive(cau_connection *connection, void *bytes, size_t most);
// True if there is more than the socket reports: the rest of a TLS record.
bool cau_connection_has_more(const cau_connection *connection);
// Sends a few bytes past libwebsockets. They are lost if the socket does not take them.
void cau_connection_put(cau_connection *connection, const void *bytes, size_t count);
// Shuts our side of the connection, so that the peer knows that nothing follows.
void cau_connection_shut(cau_connection *connection);

// Sends the last bytes of a connection that libwebsockets is about to end. They reach the peer even
// if it is still sending.
void cau_wsi_last_words(struct lws *wsi, const void *bytes, size_t count);

// ---- closing.c: outgoing bytes
void cau_connection_pong(cau_connection *connection, const void *payload, size_t bytes);

// ---- closing.c
void cau_connection_link(cau_connection **first, cau_connection *connection);
void cau_connection_unlink(cau_connection **first, cau_connection *connection);
// Notifies the handler that the connection has ended, once.
void cau_connection_leave(cau_connection *connection);
// Notes that the peer's close frame has come. Code 0: the peer gave none.
void cau_connection_closed_by_peer(cau_connection *connection, int code);
// Notes that the peer has shut its side of the socket, or that the connection is lost.
void cau_connection_ended_by_peer(cau_connection *connection);
void cau_connection_timer(cau_connection *connection);
// Continues to close when the socket can be written. Returns the callback's return value.
int cau_connection_write_close(cau_connection *connection);
// Called when libwebsockets is about to end the connection.
void cau_connection_dropped(cau_connection *connection);
// Closes the connection if nothing has been received for a long time, or if no hello came in time.
void cau_connection_watch(cau_connection *connection, double now_s);

// True if the connection's turn ends, and the next turn waits, until its replies have been written.
// This never holds for a driver: energy off must not wait until the client reads its replies.
static inline bool cau_turns_blocked(const cau_connection *c)
{
	return c->output.bytes > CAU_TURN_REPLY_BYTES && !c->end.code &&
	       c->turn.share.standing < CAU_STANDING_DRIVER;
}

// True if anything has been received from the connection.
static inline bool cau_connection_has_spoken(const cau_connection *c)
{
	return c->input.heard_s > c->opened_s;
}

static inline cau_network *cau_network_of(struct lws *wsi)
{
	return lws_context_user(lws_get_context(wsi));
}
