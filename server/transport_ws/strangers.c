// SPDX-License-Identifier: GPL-3.0-or-later
// Connections that have not said hello. Opening one needs no token, so they must not use up
// max_connections. They have a limit of their own, and a lower one for each address. Those whose
// request has not come yet are counted apart from WebSocket connections. Beyond a limit the oldest
// is closed, because a client that means to say hello does so at once.
#include <arpa/inet.h>
#include <string.h>
#include <sys/socket.h>

#include "auth/list.h"
#include "transport_ws/internal.h"

enum {
	STRANGERS_MOST = 256,
	OF_ADDRESS_MOST = 128,
	NETWORK_BYTES = 8, // of an IPv6 address: its owner chooses the rest
	RESUMES_MOST = 16, // beyond max_connections, for clients that come back to their tools
};

static bool is_same_owner(const char *a, const char *b)
{
	struct in6_addr first, second;
	if (inet_pton(AF_INET6, a, &first) == 1 && inet_pton(AF_INET6, b, &second) == 1)
		return memcmp(&first, &second, NETWORK_BYTES) == 0;
	return strcmp(a, b) == 0;
}

// Whether bytes have come that this thread has yet to read: such a one is not closed.
static bool has_input(int descriptor)
{
	char byte;
	return recv(descriptor, &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
}

// ---- connections whose request has not come yet
// The oldest that has sent nothing, of an address or (NULL) of all; NULL if at most `most` are
// open.
static cau_unread *find_unread(const cau_network *network, const char *address, int most)
{
	cau_unread *oldest = NULL;
	int count = 0;
	for (int i = 0; i < network->unread_capacity; i++) {
		cau_unread *unread = &network->unread[i];
		if (!unread->wsi || (address && !is_same_owner(unread->address, address)))
			continue;
		count++;
		if ((!oldest || unread->since_s < oldest->since_s) && !has_input(i))
			oldest = unread;
	}
	return count > most ? oldest : NULL;
}

// Behind a proxy the address is known with the request; until then it is the proxy's.
void cau_strangers_bound_unread(cau_network *network, const char *address)
{
	bool is_proxy = cau_list_has(network->def.config->trusted_proxies, address);
	cau_unread *oldest = is_proxy ? NULL : find_unread(network, address, OF_ADDRESS_MOST);
	if (!oldest)
		oldest = find_unread(network, NULL, STRANGERS_MOST);
	if (!oldest)
		return;
	network->counts.strangers_closed++;
	struct lws *wsi = oldest->wsi;
	*oldest = (cau_unread){0};
	lws_set_timeout(wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
}

// ---- WebSocket connections without hello
static bool is_silent(const cau_connection *c, const char *address)
{
	return !c->served && !c->closing && (!address || is_same_owner(c->address, address));
}

static cau_connection *find_silent(const cau_network *network, const char *address, int most)
{
	cau_connection *oldest = NULL;
	int count = 0;
	for (cau_connection *c = network->connections; c; c = c->next)
		count += is_silent(c, address);
	for (cau_connection *c = network->connections; c && count > most; c = c->next)
		if (is_silent(c, address) && !has_input(c->descriptor))
			oldest = c; // new ones come first
	return oldest;
}

void cau_strangers_bound_silent(cau_network *network, const char *address)
{
	cau_connection *oldest = find_silent(network, address, OF_ADDRESS_MOST);
	if (!oldest)
		oldest = find_silent(network, NULL, STRANGERS_MOST);
	if (!oldest)
		return;
	network->counts.strangers_closed++;
	cau_connection_close(oldest, CAU_CLOSE_FULL, "too many connections without hello");
}

// ---- places
bool cau_connection_has_place(const cau_connection *c, bool resumes)
{
	uint64_t most = (uint64_t)c->network->def.config->max_connections;
	return c->network->counts.served < most + (resumes ? RESUMES_MOST : 0);
}

void cau_connection_serve(cau_connection *c)
{
	c->network->counts.served += !c->served;
	c->served = true;
}
