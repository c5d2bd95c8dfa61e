// SPDX-License-Identifier: GPL-3.0-or-later
#include "http/response.h"

#include <libwebsockets.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

enum { HEAD_BYTES = 2048, CHUNK_BYTES = 16384, OBJECT_BYTES = 1024 };

static const char content_security_policy[] =
	"default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src "
	"'self'; "
	"connect-src 'self'; img-src 'self' data: blob:; style-src 'self'; "
	"font-src 'self'; "
	"base-uri 'none'; frame-ancestors 'none'";

typedef struct head {
	unsigned char bytes[LWS_PRE + HEAD_BYTES];
	unsigned char *at, *end;
} head;

// Returns RFC 9110's phrase for a status that this daemon sends. libwebsockets lacks some phrases.
// It also writes HTTP/1.0 in its answer to an upgrade, because it has not read the version by then.
static const char *phrase_of(unsigned status)
{
	static const struct {
		unsigned status;
		const char *phrase;
	} phrases[] = {
		{200, "OK"},
		{301, "Moved Permanently"},
		{304, "Not Modified"},
		{400, "Bad Request"},
		{401, "Unauthorized"},
		{403, "Forbidden"},
		{404, "Not Found"},
		{405, "Method Not Allowed"},
		{406, "Not Acceptable"},
		{421, "Misdirected Request"},
		{426, "Upgrade Required"},
		{431, "Request Header Fields Too Large"},
		{503, "Service Unavailable"},
	};
	for (size_t i = 0; i < sizeof phrases / sizeof *phrases; i++)
		if (phrases[i].status == status)
			return phrases[i].phrase;
	return "Unknown";
}

static int add_status(struct lws *wsi, head *h, unsigned status)
{
	char line[80];
	int bytes = snprintf(line, sizeof line, "HTTP/1.1 %u %s", status, phrase_of(status));
	return lws_add_http_header_by_name(wsi, NULL, (const unsigned char *)line, bytes, &h->at,
	                                   h->end);
}

static int add(struct lws *wsi, head *h, const char *name, const char *value)
{
	return lws_add_http_header_by_name(wsi, (const unsigned char *)name,
	                                   (const unsigned char *)value, (int)strlen(value), &h->at,
	                                   h->end);
}

static int add_all(struct lws *wsi, head *h, const cau_http_answer *answer)
{
	const struct {
		const char *name, *value;
	} headers[] = {
		{"content-type:", answer->content_type},
		{"cache-control:", answer->cache_control ? answer->cache_control : "no-store"},
		{"content-security-policy:", content_security_policy},
		{"x-content-type-options:", "nosniff"},
		{"referrer-policy:", "no-referrer"},
		{"cross-origin-opener-policy:", "same-origin"},
		{"cross-origin-resource-policy:", "same-origin"},
		{"content-encoding:", answer->content_encoding},
		{answer->extra_name, answer->extra_value},
		{"cautery-reason:", answer->reason},
		{"upgrade:", answer->status == 426 ? "websocket" : NULL},
		{"sec-websocket-version:", answer->status == 426 ? "13" : NULL},
		{"connection:", answer->last ? (answer->status == 426 ? "upgrade, close" : "close") : NULL},
	};
	for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
		if (headers[i].name && headers[i].value && add(wsi, h, headers[i].name, headers[i].value))
			return -1;
	return 0;
}

int cau_http_answer_start(struct lws *wsi, cau_http_body *body, const cau_http_answer *answer)
{
	head h;
	h.at = h.bytes + LWS_PRE;
	h.end = h.bytes + sizeof h.bytes;
	cau_http_body_finish(body);
	bool head_only = lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0;
	*body = (cau_http_body){answer->bytes, head_only ? 0 : answer->byte_count, 0, answer->owned};
	if (add_status(wsi, &h, answer->status) || add_all(wsi, &h, answer) ||
	    lws_add_http_header_content_length(wsi, answer->byte_count, &h.at, h.end) ||
	    lws_finalize_write_http_header(wsi, h.bytes + LWS_PRE, &h.at, h.end))
		return -1;
	lws_callback_on_writable(wsi);
	return 0;
}

int cau_http_answer_continue(struct lws *wsi, cau_http_body *body)
{
	unsigned char chunk[LWS_PRE + CHUNK_BYTES];
	size_t left = body->byte_count - body->sent;
	size_t now = left < CHUNK_BYTES ? left : CHUNK_BYTES;
	bool last = now == left;
	if (now)
		memcpy(chunk + LWS_PRE, (const char *)body->bytes + body->sent, now);
	if (lws_write(wsi, chunk + LWS_PRE, now, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0)
		return -1;
	body->sent += now;
	if (!last)
		return lws_callback_on_writable(wsi) < 0;
	cau_http_body_finish(body);
	return lws_http_transaction_completed(wsi) ? -1 : 0;
}

// Writes the refusal as a JSON object. All its texts are the program's own, so none needs escapes.
static int write_object(const cau_http_refusal *refusal, char *text, size_t capacity)
{
	return snprintf(text, capacity,
	                "{\"status\": %u, \"error\": \"%s\", \"where\": \"%s\", \"reason\": \"%s\", "
	                "\"remedy\": \"%s\"}\n",
	                refusal->status, refusal->name, refusal->where, refusal->reason,
	                refusal->remedy);
}

size_t cau_http_write_refusal(const cau_http_refusal *refusal, char *text, size_t capacity)
{
	char object[OBJECT_BYTES];
	int length = write_object(refusal, object, sizeof object);
	int bytes =
		snprintf(text, capacity,
	             "HTTP/1.1 %u %s\r\ncontent-type: application/json\r\n"
	             "cache-control: no-store\r\nx-content-type-options: nosniff\r\n"
	             "cautery-reason: %s\r\nconnection: close\r\ncontent-length: %d\r\n\r\n%s",
	             refusal->status, phrase_of(refusal->status), refusal->reason, length, object);
	CAU_ASSERT(bytes > 0 && (size_t)bytes < capacity, "a refusal of %d bytes", bytes);
	return (size_t)bytes;
}

int cau_http_answer_refusal(struct lws *wsi, cau_http_body *body, const cau_http_refusal *refusal,
                            bool last)
{
	char *text = malloc(OBJECT_BYTES);
	if (!text)
		return -1;
	int length = write_object(refusal, text, OBJECT_BYTES);
	cau_http_answer answer = {.status = refusal->status,
	                          .content_type = "application/json",
	                          .reason = refusal->reason,
	                          .last = last,
	                          .bytes = text,
	                          .byte_count = (size_t)length,
	                          .owned = text};
	return cau_http_answer_start(wsi, body, &answer);
}

void cau_http_body_finish(cau_http_body *body)
{
	free(body->owned);
	*body = (cau_http_body){0};
}
