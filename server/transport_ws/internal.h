// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share.
#pragma once

#include <libwebsockets.h>
#include <pthread.h>
#include <stdatomic.h>

#include "http/response.h"
#include "transport_ws/network.h"

// The name that clients ask for in Sec-WebSocket-Protocol, and the path.
#define CAU_SUBPROTOCOL "cautery.v1"
#define CAU_WS_PATH "/v1"

enum {
	HEADER_BYTES = 512,
	NOTSENT_LOWAT_BYTES = 16384, // see first_frame.c's neighbour `opened` for the reason
};

struct cau_network {
	cau_network_def def;
	struct lws_context *context;
	struct lws_vhost *vhost;
	lws_retry_bo_t validity;
	struct lws_protocols protocols[4];
	pthread_t thread;
	bool started;
	atomic_bool woken, ending;
	cau_close_code ending_code;
	double ending_until_s, ticked_s;
	int first_frames; // epoll descriptor, see first_frame.c
	uint64_t last_id;
	cau_connection *connections;
	cau_network_counts counts;
	lws_sorted_usec_list_t sul;
};

// Checks an upgrade request. Returns 0, or an HTTP status with the reason.
unsigned cau_handshake_check(cau_network *network, struct lws *wsi, const char **name,
                             const char **reason);
// Host and Origin of any request. Returns 0, or an HTTP status with the reason.
unsigned cau_request_check(cau_network *network, struct lws *wsi, const char **name,
                           const char **reason);
// Copies a header; false if it is absent or too long.
bool cau_request_header(struct lws *wsi, enum lws_token_indexes token, char *text, size_t capacity);

// One per libwebsockets protocol.
int cau_http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                      size_t bytes);
int cau_ws_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t bytes);
int cau_first_frame_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user,
                             void *in, size_t bytes);

// Watches a new connection's socket for the start of its first frame, see first_frame.c.
bool cau_first_frame_open(cau_network *network);
bool cau_first_frame_watch(cau_connection *connection);
void cau_first_frame_forget(cau_connection *connection);

// Serves a plain HTTP request.
int cau_http_serve(cau_network *network, struct lws *wsi, cau_http_body *body, const char *path);

static inline cau_network *cau_network_of(struct lws *wsi)
{
	return lws_context_user(lws_get_context(wsi));
}
