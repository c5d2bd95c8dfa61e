// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_ws/internal.h"

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
		return cau_http_serve(network, wsi, body, in);
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
