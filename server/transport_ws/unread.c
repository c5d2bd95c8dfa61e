// SPDX-License-Identifier: GPL-3.0-or-later
// Handles requests that libwebsockets 4.1.6 refuses or drops by itself. It answers some with
// HTTP/1.0 403 and no reason. It ends connections without an answer if the headers are too long, or
// if the request has no path. libwebsockets has no callback for these cases. But it calls two of
// its own public functions through the program's symbol table, so the functions of this file
// replace them. libwebsockets also logs each request that it drops. It does so while it reads that
// connection and before it ends the connection.
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include "clock/clock.h"
#include "transport_ws/internal.h"

static const cau_http_refusal bad_request = {400, "bad_request", "the request",
                                             "the request is not HTTP/1.1 with a path",
                                             "use HTTP/1.1 and a path that begins with /"};
static const cau_http_refusal too_large = {
	431, "too_large", "the headers",
	"the request and its headers are longer than this daemon reads",
	"send fewer or shorter headers: all of them in less than 4096 bytes"};

// Descriptor that this thread's libwebsockets serves now; -1: none.
static _Thread_local int served = -1;

void cau_refuse_unread(cau_network *network, struct lws *wsi, bool large)
{
	const cau_http_refusal *refusal = large ? &too_large : &bad_request;
	char text[CAU_HTTP_REFUSAL_BYTES];
	cau_note_refusal(network, wsi, refusal);
	cau_wsi_last_words(wsi, text, cau_http_write_refusal(refusal, text, sizeof text));
}

// ---- functions that replace the library's
int lws_return_http_status(struct lws *wsi, unsigned int code, const char *html_body)
{
	(void)code, (void)html_body;
	cau_refuse_request(wsi, &bad_request);
	return -1;
}

int lws_service_fd_tsi(struct lws_context *context, struct lws_pollfd *pollfd, int tsi)
{
	typedef int service(struct lws_context * context, struct lws_pollfd * pollfd, int tsi);
	static _Thread_local service *library;
	if (!library)
		// POSIX advises this form of assignment from dlsym.
		*(void **)&library = dlsym(RTLD_NEXT, "lws_service_fd_tsi");
	served = pollfd ? pollfd->fd : -1;
	int result = library(context, pollfd, tsi);
	served = -1;
	return result;
}

// ---- connections whose request has not come yet
bool cau_unread_add(cau_network *network, struct lws *wsi)
{
	int descriptor = lws_get_socket_fd(wsi);
	if (descriptor < 0)
		return true; // the connection has ended
	if (descriptor >= network->unread_capacity) {
		int capacity = 2 * (descriptor + 1);
		cau_unread *grown = realloc(network->unread, (size_t)capacity * sizeof *grown);
		if (!grown)
			return false;
		memset(grown + network->unread_capacity, 0,
		       (size_t)(capacity - network->unread_capacity) * sizeof *grown);
		network->unread = grown;
		network->unread_capacity = capacity;
	}
	cau_unread *unread = &network->unread[descriptor];
	*unread = (cau_unread){.wsi = wsi, .since_s = cau_monotonic_s()};
	lws_get_peer_simple(wsi, unread->address, sizeof unread->address);
	cau_auth_find_address(network->def.config, NULL, unread->address, sizeof unread->address);
	cau_address_owner(unread->address, unread->owner);
	cau_strangers_bound_unread(network, unread);
	return true;
}

void cau_unread_remove(cau_network *network, struct lws *wsi)
{
	int descriptor = lws_get_socket_fd(wsi);
	if (descriptor >= 0 && descriptor < network->unread_capacity)
		network->unread[descriptor] = (cau_unread){0};
}

void cau_unread_complaint(cau_network *network, const char *line)
{
	bool large = strstr(line, "header data space") || strstr(line, "hdr frags");
	bool formless =
		strstr(line, "Missing URI") || strstr(line, "saw NUL") || strstr(line, "Duplicated method");
	struct lws *wsi =
		served >= 0 && served < network->unread_capacity ? network->unread[served].wsi : NULL;
	if (!wsi || (!large && !formless))
		return;
	cau_unread_remove(network, wsi); // the request gets only one answer
	cau_refuse_unread(network, wsi, large);
}
