// SPDX-License-Identifier: GPL-3.0-or-later
// Connections that have not said hello. Opening one needs no token, so they must not use up
// max_connections. They have a limit of their own, and a lower one for each address. Those whose
// request has not come yet are counted apart from WebSocket connections. Beyond a limit the oldest
// is closed, because a client that means to say hello does so at once.
#include <arpa/inet.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "auth/list.h"
#include "clock/clock.h"
#include "transport_ws/internal.h"

enum {
	STRANGERS_MOST = 256,
	UNREAD_MOST = 512, // of two addresses whose requests are late
	OF_ADDRESS_MOST = 128,
	NETWORK_BYTES = 8, // of an IPv6 address: its owner chooses the rest
	RESUMES_MOST = 16, // beyond max_connections, for clients that come back to their tools
};

#define READ_WITHIN_S 0.02 // the thread reads bytes within this time of their arrival
#define REQUEST_S 1.0      // from connecting to a request, on a busy machine

void cau_address_owner(const char *address, char owner[CAU_ADDRESS_BYTES])
{
	struct in6_addr parsed;
	snprintf(owner, CAU_ADDRESS_BYTES, "%s", address);
	if (inet_pton(AF_INET6, address, &parsed) != 1)
		return;
	memset(parsed.s6_addr + NETWORK_BYTES, 0, sizeof parsed.s6_addr - NETWORK_BYTES);
	inet_ntop(AF_INET6, &parsed, owner, CAU_ADDRESS_BYTES);
}

// ---- connections whose request has not come yet
static bool is_unread(const cau_unread *unread, const char *owner)
{
	return unread->wsi && (!owner || strcmp(unread->owner, owner) == 0);
}

// Bytes that had arrived are read by now, or within moments. Later the connection is asked again.
static bool is_read_soon(const cau_unread *unread, double now_s)
{
	return now_s - unread->input_s < READ_WITHIN_S;
}

// Whether bytes have come that this thread has yet to read: such a one is not closed.
static bool has_input(int descriptor)
{
	struct pollfd polled = {.fd = descriptor, .events = POLLIN};
	return poll(&polled, 1, 0) > 0 && polled.revents & POLLIN;
}

// The oldest of an owner, or (NULL) of all, of which nothing is known to have come, and their
// count.
static cau_unread *find_oldest(const cau_network *network, const char *owner, double now_s,
                               int *count)
{
	cau_unread *oldest = NULL;
	*count = 0;
	for (int i = 0; i < network->unread_capacity; i++) {
		cau_unread *unread = &network->unread[i];
		if (!is_unread(unread, owner) || is_read_soon(unread, now_s))
			continue;
		++*count;
		if (!oldest || unread->since_s < oldest->since_s)
			oldest = unread;
	}
	return oldest;
}

// The oldest of which nothing has come; NULL if there are at most `most` of these, or at most twice
// as many while that one is younger than `young_s`. Only the one that would be closed is asked:
// many connect at once, and this is called for each of them.
static cau_unread *find_unread(cau_network *network, const char *owner, int most, double young_s)
{
	int count;
	double now_s = cau_monotonic_s();
	for (;;) {
		cau_unread *oldest = find_oldest(network, owner, now_s, &count);
		if (!oldest)
			return NULL;
		bool young = now_s - oldest->since_s < young_s;
		if (count <= (young ? 2 * most : most))
			return NULL;
		if (!has_input((int)(oldest - network->unread)))
			return oldest;
		oldest->input_s = now_s;
	}
}

// Behind a proxy the address is known with the request; until then it is the proxy's.
void cau_strangers_bound_unread(cau_network *network, const cau_unread *newest)
{
	bool is_proxy = cau_list_has(network->def.config->trusted_proxies, newest->address);
	cau_unread *oldest =
		is_proxy ? NULL : find_unread(network, newest->owner, OF_ADDRESS_MOST, REQUEST_S);
	if (!oldest)
		oldest = find_unread(network, NULL, UNREAD_MOST, 0);
	if (!oldest)
		return;
	network->counts.strangers_closed++;
	struct lws *wsi = oldest->wsi;
	*oldest = (cau_unread){0};
	lws_set_timeout(wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
}

// ---- WebSocket connections without hello
static bool is_silent(const cau_connection *c, const char *owner)
{
	return !c->served && !c->closing && (!owner || strcmp(c->owner, owner) == 0);
}

// A client says hello first. Whoever said something else, or says nothing, may be closed.
static bool says_no_hello(const cau_connection *c)
{
	return cau_connection_has_spoken(c) || (!c->waits && !has_input(c->descriptor));
}

// The oldest that says no hello; NULL if none is to be closed. New ones come first in the list. The
// newest `most` are never closed: their hello may be on its way. Beyond twice as many the oldest is
// closed although something of it waits to be read.
static cau_connection *find_silent(const cau_network *network, const char *owner, int most)
{
	cau_connection *last = NULL, *oldest = NULL;
	int count = 0;
	for (cau_connection *c = network->connections; c; c = c->next) {
		count += is_silent(c, owner);
		last = c;
	}
	bool too_many = count > 2 * most;
	for (cau_connection *c = last; c && count > most; c = c->previous) {
		if (!is_silent(c, owner))
			continue;
		count--;
		oldest = oldest ? oldest : c;
		if (says_no_hello(c))
			return c;
	}
	return too_many ? oldest : NULL;
}

void cau_strangers_bound_silent(cau_network *network, const cau_connection *newest)
{
	cau_connection *oldest = find_silent(network, newest->owner, OF_ADDRESS_MOST);
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

void cau_connection_serve(cau_connection *c, cau_role role)
{
	cau_share_promote(&c->share, cau_standing_of_role(role), cau_monotonic_s());
	c->network->counts.served += !c->served;
	c->served = true;
}
