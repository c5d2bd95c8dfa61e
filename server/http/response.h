// SPDX-License-Identifier: GPL-3.0-or-later
// Answers to HTTP requests: small ones made for the request, and files from memory.
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct lws;

// A body that is sent piece by piece as the connection can take it. The connection's HTTP state
// owns it.
typedef struct cau_http_body {
	const void *bytes;
	size_t byte_count;
	size_t sent;
	void *owned; // freed with the state; NULL if the bytes belong to another owner
} cau_http_body;

typedef struct cau_http_answer {
	unsigned status;              // 200, 404, ...
	const char *content_type;     // "application/json", ...
	const char *content_encoding; // NULL or "gzip"
	const char *cache_control;    // NULL: the header is "no-store"
	const char *extra_name; // name of one more header, "www-authenticate:"; NULL: no more header
	const char *extra_value;
	// header cautery-reason: one sentence for clients that see only the head; NULL: no such header
	const char *reason;
	bool last; // the connection ends after this answer
	const void *bytes;
	size_t byte_count;
	void *owned; // malloc'ed; the answer takes it
} cau_http_answer;

// Sends the head with the security headers, and begins to send the body. Returns the lws callback's
// return value.
int cau_http_answer_start(struct lws *wsi, cau_http_body *body, const cau_http_answer *answer);

// Continues to send the body when the socket can take more.
int cau_http_answer_continue(struct lws *wsi, cau_http_body *body);

// Why a request is not served, in the program's own words.
typedef struct cau_http_refusal {
	unsigned status;    // HTTP status; 0: the request is served
	const char *name;   // one word for programs: "bad_origin"
	const char *where;  // the wrong header or request line
	const char *reason; // the reason: a sentence
	const char *remedy; // what to do: a sentence
} cau_http_refusal;

// Answers with the refusal as one line of JSON, and its reason as a header. `last`: the connection
// ends afterwards.
int cau_http_answer_refusal(struct lws *wsi, cau_http_body *body, const cau_http_refusal *refusal,
                            bool last);

// Writes the answer of a refusal as bytes for a socket; it announces the connection's end. Returns
// the number of bytes. `capacity` is CAU_HTTP_REFUSAL_BYTES.
enum { CAU_HTTP_REFUSAL_BYTES = 2048 };
size_t cau_http_write_refusal(const cau_http_refusal *refusal, char *text, size_t capacity);

void cau_http_body_finish(cau_http_body *body);
