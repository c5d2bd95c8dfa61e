// SPDX-License-Identifier: GPL-3.0-or-later
// libwebsockets lets pass what RFC 6455 and our rules forbid: a missing subprotocol, other
// versions, any Origin and Host. This is the door.
#include <string.h>

#include "transport_ws/internal.h"

bool cau_request_header(struct lws *wsi, enum lws_token_indexes token, char *text, size_t capacity)
{
	int length = lws_hdr_total_length(wsi, token);
	text[0] = 0;
	if (length <= 0 || (size_t)length >= capacity)
		return false;
	return lws_hdr_copy(wsi, text, (int)capacity, token) > 0;
}

unsigned cau_request_check(cau_network *network, struct lws *wsi, const char **name,
                           const char **reason)
{
	char host[HEADER_BYTES], origin[HEADER_BYTES];
	const cau_config *config = network->def.config;
	if (!cau_request_header(wsi, WSI_TOKEN_HOST, host, sizeof host) ||
	    !cau_auth_host_allowed(config, host)) {
		*name = "bad_host";
		*reason = "the Host header does not name this daemon (setting hosts)";
		return 421;
	}
	bool present = lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) > 0;
	if (present && (!cau_request_header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof origin) ||
	                !cau_auth_origin_allowed(config, origin, host))) {
		*name = "bad_origin";
		*reason = "pages of this Origin may not use this daemon (setting origins)";
		return 403;
	}
	return 0;
}

// Whether the comma-separated list offers our subprotocol.
static bool offers_subprotocol(const char *list)
{
	size_t length = strlen(CAU_SUBPROTOCOL);
	while (*list) {
		list += strspn(list, " ,\t");
		size_t item = strcspn(list, " ,\t");
		if (item == length && strncmp(list, CAU_SUBPROTOCOL, length) == 0)
			return true;
		list += item;
	}
	return false;
}

unsigned cau_handshake_check(cau_network *network, struct lws *wsi, const char **name,
                             const char **reason)
{
	char text[HEADER_BYTES];
	unsigned status = cau_request_check(network, wsi, name, reason);
	if (status)
		return status;
	*name = "bad_handshake";
	if (!cau_request_header(wsi, WSI_TOKEN_GET_URI, text, sizeof text) ||
	    strcmp(text, CAU_WS_PATH) != 0) {
		*reason = "WebSocket is at " CAU_WS_PATH;
		return 404;
	}
	if (!cau_request_header(wsi, WSI_TOKEN_VERSION, text, sizeof text) || strcmp(text, "13") != 0) {
		*reason = "Sec-WebSocket-Version must be 13";
		return 426;
	}
	if (!cau_request_header(wsi, WSI_TOKEN_PROTOCOL, text, sizeof text) ||
	    !offers_subprotocol(text)) {
		*reason = "Sec-WebSocket-Protocol must offer " CAU_SUBPROTOCOL;
		return 400;
	}
	if (network->counts.connections >= (uint64_t)network->def.config->max_connections) {
		*name = "limit";
		*reason = "too many connections (setting max_connections)";
		return 503;
	}
	return 0;
}
