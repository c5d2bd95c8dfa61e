// SPDX-License-Identifier: GPL-3.0-or-later
// Limits connections that have not said hello ("strangers"). Opening one needs no token, so they
// must not use up max_connections. They have a limit of their own, and a lower limit for each
// address. Connections whose request has not come yet are counted apart from WebSocket connections.
// Beyond a limit the oldest is closed, because an honest client says hello at once. But a message
// may take long to arrive, and closed strangers may reconnect thousands of times in a second. So a
// connection younger than GRACE_S is closed only beyond GRACE_FACTOR times the limit.
#include <arpa/inet.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "auth/auth.h"
#include "clock/clock.h"
#include "transport_ws/internal.h"

enum {
	STRANGERS_MOST = 256,
	// Largest number of connections whose request has not come, of all addresses together. It
	// allows four addresses at their limit. Each such connection uses a file descriptor and no
	// more.
	UNREAD_MOST = 512,
	OF_ADDRESS_MOST = 128,
	// Factor on the limits while the oldest connection is younger than GRACE_S. Strangers reconnect
	// 4,000 times in a second, which is 512 times in an eighth of a second.
	GRACE_FACTOR = 8,
	// length of the network part of an IPv6 address; its owner chooses the remaining bytes
	NETWORK_BYTES = 8,
	RESUMES_MOST = 16, // connections beyond max_connections, for clients that return to their tools
};

#define READ_WITHIN_S 0.02 // longest time from the arrival of bytes until the thread reads them, s
// Time that a client has for its request and for hello, from far away or from a busy machine, s.
#define GRACE_S 1.0

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

// True if unread bytes were seen less than READ_WITHIN_S ago: the thread reads them within that
// time. Afterwards the connection is checked again.
static bool is_read_soon(const cau_unread *unread, double now_s)
{
	return now_s - unread->input_s < READ_WITHIN_S;
}

// True if bytes have arrived that this thread has not read yet. Such a connection is not closed.
static bool has_input(int descriptor)
{
	struct pollfd polled = {.fd = descriptor, .events = POLLIN};
	return poll(&polled, 1, 0) > 0 && polled.revents & POLLIN;
}

// Finds the oldest connection without a request of an owner (NULL: of all owners), without those
// whose bytes are about to be read. *count: the number of such connections.
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

// Returns the largest number of connections that is allowed while the oldest has this age.
static int bound(int most, double age_s)
{
	return age_s < GRACE_S ? GRACE_FACTOR * most : most;
}

// Finds the connection to close: the oldest without a request, if there are too many and no bytes
// of it have arrived. Otherwise returns NULL. Only the connection that would be closed is polled,
// because this runs for each new connection.
static cau_unread *find_unread(cau_network *network, const char *owner, int most)
{
	int count;
	double now_s = cau_monotonic_s();
	for (;;) {
		cau_unread *oldest = find_oldest(network, owner, now_s, &count);
		if (!oldest || count <= bound(most, now_s - oldest->since_s))
			return NULL;
		if (!has_input((int)(oldest - network->unread)))
			return oldest;
		oldest->input_s = now_s;
	}
}

// Closes a connection if too many connections have not sent their request. Behind a proxy, the
// client's address is known only from the request. Before the request the address is the proxy's,
// so the limit for each address is skipped.
void cau_strangers_bound_unread(cau_network *network, const cau_unread *newest)
{
	bool is_proxy = cau_list_has(network->def.config->trusted_proxies, newest->address);
	cau_unread *oldest = is_proxy ? NULL : find_unread(network, newest->owner, OF_ADDRESS_MOST);
	if (!oldest)
		oldest = find_unread(network, NULL, UNREAD_MOST);
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
	return !c->served && !c->end.code && (!owner || strcmp(c->owner, owner) == 0);
}

// Finds the oldest connection without hello of an owner (NULL: of all owners). *count: the number
// of such connections. The list has the newest connection first.
static cau_connection *find_silent(const cau_network *network, const char *owner, int *count)
{
	cau_connection *oldest = NULL;
	*count = 0;
	for (cau_connection *c = network->connections; c; c = c->next)
		if (is_silent(c, owner)) {
			oldest = c;
			++*count;
		}
	return oldest;
}

static void close_silent(cau_connection *c)
{
	c->network->counts.strangers_closed++;
	_Static_assert(OF_ADDRESS_MOST == 128 && STRANGERS_MOST == 256, "the reason names both");
	cau_connection_close(
		c, CAU_CLOSE_FULL,
		"too many connections without hello (at most 128 of an address, 256 of all)");
}

// Closes the oldest connection without hello if there are too many. Only the oldest is checked for
// unread input, which may be its hello. This runs for each new connection, and strangers open many.
static bool bound_silent(const cau_network *network, const char *owner, int most)
{
	int count;
	cau_connection *oldest = find_silent(network, owner, &count);
	if (!oldest || count <= bound(most, cau_monotonic_s() - oldest->opened_s))
		return false;
	if (count <= bound(most, 0) && (oldest->turn.waits || has_input(oldest->descriptor)))
		return false;
	close_silent(oldest);
	return true;
}

void cau_strangers_bound_silent(cau_network *network, const cau_connection *newest)
{
	if (!bound_silent(network, newest->owner, OF_ADDRESS_MOST))
		bound_silent(network, NULL, STRANGERS_MOST);
}

void cau_strangers_bound_talk(cau_connection *c)
{
	int of_owner, all;
	find_silent(c->network, c->owner, &of_owner);
	find_silent(c->network, NULL, &all);
	if (of_owner > OF_ADDRESS_MOST || all > STRANGERS_MOST)
		close_silent(c);
}

// ---- limits on served connections
bool cau_connection_has_place(const cau_connection *c, bool resumes)
{
	uint64_t most = (uint64_t)c->network->def.config->max_connections;
	return c->network->counts.served < most + (resumes ? RESUMES_MOST : 0);
}

void cau_connection_serve(cau_connection *c, cau_role role)
{
	cau_share_promote(&c->turn.share, cau_standing_of_role(role), cau_monotonic_s());
	c->network->counts.served += !c->served;
	c->served = true;
}
