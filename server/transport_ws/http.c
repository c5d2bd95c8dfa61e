// SPDX-License-Identifier: GPL-3.0-or-later
// Plain HTTP: pages that the handler makes, and the files of the viewer and the manual, from
// memory.
#include <stdlib.h>
#include <string.h>

#include "transport_ws/internal.h"

// ---- pages and files
static bool is_page(const char *path)
{
	return strcmp(path, "/healthz") == 0 || strcmp(path, "/readyz") == 0 ||
	       strcmp(path, "/metrics") == 0 || strcmp(path, "/api/sessions") == 0 ||
	       strcmp(path, "/api/fleet") == 0;
}

// True if the page needs a token. /api/fleet needs none, because the viewer requests it before it
// has a token. Whether a daemon belongs to a fleet is no secret.
static bool needs_token(const char *path)
{
	if (strcmp(path, "/api/fleet") == 0)
		return false;
	return strcmp(path, "/metrics") == 0 || strncmp(path, "/api/", 5) == 0;
}

// True if the request has a valid Authorization: Bearer TOKEN, or no tokens are in use. The pages
// show every session, so a token for only some sessions does not open them.
static bool may_read(cau_network *network, struct lws *wsi)
{
	static const char scheme[] = "Bearer ";
	char text[HEADER_BYTES];
	if (!cau_auth_required(network->def.auth))
		return true;
	return cau_request_header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION, text, sizeof text) &&
	       strncmp(text, scheme, sizeof scheme - 1) == 0 &&
	       cau_auth_sees_all(network->def.auth, text + sizeof scheme - 1,
	                         strlen(text) - (sizeof scheme - 1));
}

static int serve_page(cau_network *network, struct lws *wsi, cau_http_body *body, const char *path)
{
	if (needs_token(path) && !may_read(network, wsi)) {
		network->counts.refused_tokens++;
		cau_http_answer denied = {.status = 401,
		                          .content_type = "application/json",
		                          .extra_name = "www-authenticate:",
		                          .extra_value = "Bearer"};
		return cau_http_answer_start(wsi, body, &denied);
	}
	// An Accept header that is longer than ours counts as absent.
	char accept[HEADER_BYTES];
	if (!cau_request_header(wsi, WSI_TOKEN_HTTP_ACCEPT, accept, sizeof accept))
		accept[0] = 0;
	cau_page page = {.path = path, .accept = accept};
	network->def.handler.page(network->def.handler.user, &page);
	cau_http_answer answer = {.status = page.status,
	                          .content_type = page.content_type,
	                          .extra_name = "vary:",
	                          .extra_value = "accept",
	                          .bytes = page.body,
	                          .byte_count = page.bytes,
	                          .owned = page.body};
	return cau_http_answer_start(wsi, body, &answer);
}

static int serve_file(struct lws *wsi, cau_http_body *body, const cau_static_file *file)
{
	char accepted[HEADER_BYTES];
	bool gzip =
		file->gzip &&
		cau_request_header(wsi, WSI_TOKEN_HTTP_ACCEPT_ENCODING, accepted, sizeof accepted) &&
		strstr(accepted, "gzip");
	cau_http_answer answer = {
		.status = 200,
		.content_type = file->content_type,
		.content_encoding = gzip ? "gzip" : NULL,
		.cache_control = file->hashed ? "public, max-age=31536000, immutable" : "no-cache",
		.extra_name = "vary:",
		.extra_value = "accept-encoding",
		.bytes = gzip ? file->gzip : file->plain,
		.byte_count = gzip ? file->gzip_bytes : file->plain_bytes,
	};
	return cau_http_answer_start(wsi, body, &answer);
}

// Serves a file. The manual's pages are under /manual/; every other path is the viewer's.
static int serve_files(cau_network *network, struct lws *wsi, cau_http_body *body, const char *path)
{
	static const char manual[] = "/manual";
	static const cau_http_refusal not_found = {404, "not_found", "the path",
	                                           "no page has this path", "open the page /"};
	static const cau_http_refusal no_manual = {
		404, "not_found", "the path", "no manual is installed here",
		"set the folder of the manual with the setting manual"};
	size_t length = sizeof manual - 1;
	const cau_static_files *files = network->def.files;
	if (strcmp(path, manual) == 0) {
		cau_http_answer moved = {
			.status = 301, .extra_name = "location:", .extra_value = "/manual/"};
		return cau_http_answer_start(wsi, body, &moved);
	}
	if (strncmp(path, manual, length) == 0 && path[length] == '/') {
		files = network->def.manual;
		path += length;
	}
	if (!files)
		return cau_http_answer_refusal(wsi, body, &no_manual, false);
	const cau_static_file *file = cau_static_files_find(files, path);
	return file ? serve_file(wsi, body, file)
	            : cau_http_answer_refusal(wsi, body, &not_found, false);
}

static int serve_request(cau_network *network, struct lws *wsi, cau_http_body *body,
                         const char *path)
{
	static const cau_http_refusal bad_method = {405, "bad_method", "the method",
	                                            "only GET and HEAD are served", "use GET"};
	static const cau_http_refusal no_upgrade = {426, "bad_handshake", "the path",
	                                            "this path is only for WebSocket",
	                                            "connect with a WebSocket client"};
	cau_http_refusal refusal = cau_request_check(network, wsi);
	if (refusal.status)
		return cau_http_answer_refusal(wsi, body, &refusal, false);
	if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0 &&
	    lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) <= 0)
		return cau_http_answer_refusal(wsi, body, &bad_method, false);
	if (is_page(path))
		return serve_page(network, wsi, body, path);
	if (strcmp(path, CAU_WS_PATH) == 0)
		return cau_http_answer_refusal(wsi, body, &no_upgrade, false);
	return serve_files(network, wsi, body, path);
}

// ---- the callback
// Returns a negative value if the upgrade is refused; the connection then ends behind the answer.
static int confirm_upgrade(cau_network *network, struct lws *wsi)
{
	cau_http_refusal refusal = cau_handshake_check(network, wsi);
	if (!refusal.status)
		return 0;
	cau_refuse_request(wsi, &refusal);
	return -1;
}

static void close_all(cau_network *network)
{
	for (cau_connection *c = network->connections; c; c = c->next)
		cau_connection_close(c, network->ending_code, NULL);
}

int cau_http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                      size_t bytes)
{
	cau_network *network = cau_network_of(wsi);
	cau_http_body *body = user;
	switch (reason) {
	// libwebsockets has made its TLS context.
	case LWS_CALLBACK_OPENSSL_LOAD_EXTRA_SERVER_VERIFY_CERTS:
		if (network->tls)
			cau_tls_configure(network->tls, user);
		return 0;
	case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
		return cau_unread_add(network, wsi) ? 0 : -1;
	case LWS_CALLBACK_HTTP:
		cau_unread_remove(network, wsi);
		return serve_request(network, wsi, body, in);
	case LWS_CALLBACK_HTTP_WRITEABLE:
		return cau_http_answer_continue(wsi, body);
	// The answer is sent, and the connection's next request may come.
	case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
		return cau_unread_add(network, wsi) ? 0 : -1;
	case LWS_CALLBACK_CLOSED_HTTP:
		cau_unread_remove(network, wsi);
		if (body)
			cau_http_body_finish(body);
		return 0;
	// The request is CONNECT. libwebsockets would pass the bytes to no handler.
	case LWS_CALLBACK_RAW_ADOPT:
		cau_refuse_unread(network, wsi, false);
		return -1;
	case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
		cau_unread_remove(network, wsi);
		return confirm_upgrade(network, wsi);
	case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
		if (network->ending)
			close_all(network);
		else if (atomic_exchange(&network->woken, false))
			network->def.handler.woken(network->def.handler.user);
		return 0;
	default:
		return lws_callback_http_dummy(wsi, reason, NULL, in, bytes);
	}
}
