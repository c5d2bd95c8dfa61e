// SPDX-License-Identifier: GPL-3.0-or-later
// Checks upgrade requests. libwebsockets accepts what RFC 6455 and our rules forbid (a missing
// subprotocol, other versions, any Origin and Host). It closes without an answer if it cannot use
// the request (no key, no Connection). Here each refusal names the error, its header and the
// remedy.
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "transport_ws/internal.h"

// ---- checks of requests
bool cau_request_header(struct lws *wsi, enum lws_token_indexes token, char *text, size_t capacity)
{
	int length = lws_hdr_total_length(wsi, token);
	text[0] = 0;
	if (length <= 0 || (size_t)length >= capacity)
		return false;
	return lws_hdr_copy(wsi, text, (int)capacity, token) > 0;
}

cau_http_refusal cau_request_check(cau_network *network, struct lws *wsi)
{
	static const cau_http_refusal served = {0};
	static const cau_http_refusal bad_host = {
		421, "bad_host", "Host", "the Host header does not name this daemon (setting hosts)",
		"use an address that the daemon listens on, or add the name to its "
		"setting hosts"};
	static const cau_http_refusal bad_origin = {
		403, "bad_origin", "Origin",
		"pages of this Origin may not use this daemon (setting origins)",
		"open the daemon's own page, or add the page's Origin to its setting "
		"origins"};
	char host[HEADER_BYTES], origin[HEADER_BYTES];
	const cau_config *config = network->def.config;
	if (!cau_request_header(wsi, WSI_TOKEN_HOST, host, sizeof host) ||
	    !cau_auth_host_allowed(config, host))
		return bad_host;
	bool present = lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) > 0;
	if (present && (!cau_request_header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof origin) ||
	                !cau_auth_origin_allowed(config, origin, host)))
		return bad_origin;
	return served;
}

// True if the comma-separated list contains `wanted`, ignoring case.
static bool names(const char *list, const char *wanted)
{
	size_t length = strlen(wanted);
	while (*list) {
		list += strspn(list, " ,\t");
		size_t item = strcspn(list, " ,\t");
		if (item == length && strncasecmp(list, wanted, length) == 0)
			return true;
		list += item;
	}
	return false;
}

// ---- requirements of an upgrade
static bool has_path(struct lws *wsi)
{
	char text[HEADER_BYTES];
	return cau_request_header(wsi, WSI_TOKEN_GET_URI, text, sizeof text) &&
	       strcmp(text, CAU_WS_PATH) == 0;
}

static bool has_upgrade(struct lws *wsi)
{
	char upgrade[HEADER_BYTES], connection[HEADER_BYTES];
	return cau_request_header(wsi, WSI_TOKEN_UPGRADE, upgrade, sizeof upgrade) &&
	       names(upgrade, "websocket") &&
	       cau_request_header(wsi, WSI_TOKEN_CONNECTION, connection, sizeof connection) &&
	       names(connection, "upgrade");
}

static bool has_version(struct lws *wsi)
{
	char text[HEADER_BYTES];
	return cau_request_header(wsi, WSI_TOKEN_VERSION, text, sizeof text) && strcmp(text, "13") == 0;
}

// True if the key is 16 bytes in base 64: 22 digits and two padding characters.
static bool has_key(struct lws *wsi)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	char text[HEADER_BYTES];
	return cau_request_header(wsi, WSI_TOKEN_KEY, text, sizeof text) && strlen(text) == 24 &&
	       strspn(text, digits) == 22 && strcmp(text + 22, "==") == 0;
}

// True if the request lists our subprotocol. This version of libwebsockets cannot read a list that
// is longer than LIST_BYTES.
static bool has_subprotocol(struct lws *wsi)
{
	enum { LIST_BYTES = 128 };
	char text[LIST_BYTES];
	return cau_request_header(wsi, WSI_TOKEN_PROTOCOL, text, sizeof text - 1) &&
	       names(text, CAU_SUBPROTOCOL);
}

cau_http_refusal cau_handshake_check(cau_network *network, struct lws *wsi)
{
	static const struct {
		bool (*passes)(struct lws *wsi);
		cau_http_refusal refusal;
	} checks[] = {
		{has_path,
	     {404, "bad_handshake", "the path", "WebSocket is at " CAU_WS_PATH,
	      "connect to " CAU_WS_PATH ", with ?session=ID or without"}},
		{has_version,
	     {426, "bad_handshake", "Sec-WebSocket-Version", "Sec-WebSocket-Version must be 13",
	      "use a client that speaks RFC 6455"}},
		{has_upgrade,
	     {400, "bad_handshake", "Connection and Upgrade",
	      "Connection must say upgrade, and Upgrade websocket",
	      "configure proxies in between to forward both headers"}},
		{has_key,
	     {400, "bad_handshake", "Sec-WebSocket-Key",
	      "Sec-WebSocket-Key must be 16 bytes in base 64", "use a client that speaks RFC 6455"}},
		{has_subprotocol,
	     {400, "bad_handshake", "Sec-WebSocket-Protocol",
	      "Sec-WebSocket-Protocol must contain " CAU_SUBPROTOCOL ", in at most 126 bytes",
	      "offer the subprotocol " CAU_SUBPROTOCOL}},
	};
	cau_http_refusal refusal = cau_request_check(network, wsi);
	for (size_t i = 0; i < sizeof checks / sizeof *checks && !refusal.status; i++)
		if (!checks[i].passes(wsi))
			refusal = checks[i].refusal;
	return refusal;
}

// ---- refusals
// A refused request is counted and noted for the log. libwebsockets sends the answer.

void cau_note_refusal(cau_network *network, struct lws *wsi, const cau_http_refusal *refusal)
{
	char address[CAU_ADDRESS_BYTES] = "", owner[CAU_ADDRESS_BYTES], forwarded[HEADER_BYTES];
	char reason[CAU_CLOSE_REASON_BYTES];
	network->counts.refused_handshakes++;
	lws_get_peer_simple(wsi, address, sizeof address);
	bool told = cau_request_header(wsi, WSI_TOKEN_X_FORWARDED_FOR, forwarded, sizeof forwarded);
	cau_auth_find_address(network->def.config, told ? forwarded : NULL, address, sizeof address);
	cau_address_owner(address, owner);
	snprintf(reason, sizeof reason, "%u %s: %s", refusal->status, refusal->name, refusal->reason);
	cau_outsiders_note(network, owner, reason);
}

void cau_refuse_request(struct lws *wsi, const cau_http_refusal *refusal)
{
	cau_http_body body = {0};
	cau_note_refusal(cau_network_of(wsi), wsi, refusal);
	if (!cau_http_answer_refusal(wsi, &body, refusal, true))
		cau_http_answer_continue(wsi, &body);
	cau_http_body_finish(&body);
}
