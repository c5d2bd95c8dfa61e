// SPDX-License-Identifier: GPL-3.0-or-later
#include "http/response.h"

#include <libwebsockets.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD_BYTES = 2048, CHUNK_BYTES = 16384 };

static const char content_security_policy[] =
	"default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; "
	"connect-src 'self'; img-src 'self' data: blob:; style-src 'self'; font-src 'self'; "
	"base-uri 'none'; frame-ancestors 'none'";

typedef struct head {
	unsigned char bytes[LWS_PRE + HEAD_BYTES];
	unsigned char *at, *end;
} head;

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
	if (lws_add_http_header_status(wsi, answer->status, &h.at, h.end) || add_all(wsi, &h, answer) ||
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

int cau_http_answer_reason(struct lws *wsi, cau_http_body *body, unsigned status, const char *name,
                           const char *reason)
{
	char *text = malloc(512);
	if (!text)
		return -1;
	int length =
		snprintf(text, 512, "{\"error\": \"%.60s\", \"reason\": \"%.400s\"}\n", name, reason);
	cau_http_answer answer = {.status = status,
	                          .content_type = "application/json",
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
