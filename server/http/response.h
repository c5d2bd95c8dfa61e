// SPDX-License-Identifier: GPL-3.0-or-later
// Answers to HTTP requests: small ones made on the spot, files from memory.
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct lws;

// A body that is sent as the connection takes it. Owned by the connection's
// HTTP state.
typedef struct cau_http_body {
	const void *bytes;
	size_t byte_count;
	size_t sent;
	void *owned; // freed with the state; NULL if the bytes live elsewhere
} cau_http_body;

typedef struct cau_http_answer {
	unsigned status;              // 200, 404, ...
	const char *content_type;     // "application/json", ...
	const char *content_encoding; // NULL or "gzip"
	const char *cache_control;    // NULL: "no-store"
	const char *extra_name;       // one more header, "www-authenticate:"; NULL: none
	const char *extra_value;
	const char *reason; // cautery-reason: one sentence, for clients that see the
	                    // head alone; or NULL
	bool last;          // the connection ends with it
	const void *bytes;
	size_t byte_count;
	void *owned; // malloc'ed; taken
} cau_http_answer;

// Sends the head with the security headers and starts the body. Returns what
// the lws callback is to return.
int cau_http_answer_start(struct lws *wsi, cau_http_body *body, const cau_http_answer *answer);

// Continues the body when the socket can take more.
int cau_http_answer_continue(struct lws *wsi, cau_http_body *body);

// Why a request is not served, in the program's own words.
typedef struct cau_http_refusal {
	unsigned status;    // HTTP's; 0: it is served
	const char *name;   // a word for programs: "bad_origin"
	const char *where;  // the header or the line of the request that is at fault
	const char *reason; // a sentence
	const char *remedy; // what to do, a sentence
} cau_http_refusal;

// Answers with the refusal as one line of JSON and its reason as a header.
// `last`: the connection ends with it.
int cau_http_answer_refusal(struct lws *wsi, cau_http_body *body, const cau_http_refusal *refusal,
                            bool last);

// The same as bytes for a socket, with the connection's end; returns how many. `capacity`:
// CAU_HTTP_REFUSAL_BYTES.
enum { CAU_HTTP_REFUSAL_BYTES = 2048 };
size_t cau_http_write_refusal(const cau_http_refusal *refusal, char *text, size_t capacity);

void cau_http_body_finish(cau_http_body *body);
