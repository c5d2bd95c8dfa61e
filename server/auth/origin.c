// SPDX-License-Identifier: GPL-3.0-or-later
// Where a request comes from: the checks of Host and Origin, and the client's address behind
// proxies.
#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "auth/auth.h"

// ---- Host and Origin ----------------------------------------------------------------------------

bool cau_list_has(const char *list, const char *text)
{
	size_t length = strlen(text);
	while (*list) {
		size_t item = strcspn(list, ",");
		size_t start = strspn(list, " ");
		size_t end = item;
		while (end > start && list[end - 1] == ' ')
			end--;
		if (end > start && end - start == length && strncasecmp(list + start, text, length) == 0)
			return true;
		list += item + (list[item] == ',');
	}
	return false;
}

// Splits "name:port" or "[address]:port"; *port is -1 if the text has no port. Returns false if the
// text is malformed.
static bool split_host(const char *host, char *name, size_t capacity, long *port)
{
	const char *colon = strrchr(host, ':');
	const char *bracket = strrchr(host, ']');
	*port = -1;
	if (colon && (!bracket || colon > bracket)) {
		char *end;
		*port = strtol(colon + 1, &end, 10);
		if (end == colon + 1 || *end || *port < 1 || *port > 65535)
			return false;
	} else {
		colon = host + strlen(host);
	}
	if (*host == '[' && bracket == colon - 1 && colon - host > 2) {
		host++;
		colon--;
	}
	size_t length = (size_t)(colon - host);
	if (length == 0 || length >= capacity)
		return false;
	memcpy(name, host, length);
	name[length] = 0;
	return true;
}

bool cau_auth_host_allowed(const cau_config *config, const char *host)
{
	char name[256];
	long port;
	if (!host || !split_host(host, name, sizeof name, &port))
		return false;
	if (cau_list_has(config->hosts, name) || cau_list_has(config->hosts, host))
		return true;
	if (port != -1 && port != config->port)
		return false;
	return strcasecmp(name, "localhost") == 0 || strcmp(name, "127.0.0.1") == 0 ||
	       strcmp(name, "::1") == 0 || strcasecmp(name, config->listen) == 0;
}

bool cau_auth_origin_allowed(const cau_config *config, const char *origin, const char *host)
{
	if (!origin || !*origin || cau_list_has(config->origins, origin))
		return true;
	char own[320];
	snprintf(own, sizeof own, "http://%.256s", host ? host : "");
	return host && (strcasecmp(origin, own) == 0 ||
	                (strncasecmp(origin, "https://", 8) == 0 && strcasecmp(origin + 8, host) == 0));
}

// ---- the client's address -----------------------------------------------------------------------

static bool is_address(const char *text)
{
	struct in6_addr address; // in6_addr, the larger of both types
	return inet_pton(AF_INET, text, &address) == 1 || inet_pton(AF_INET6, text, &address) == 1;
}

// Replaces ::ffff:10.0.0.1 by 10.0.0.1. On an IPv6 socket the system shows an IPv4 peer in the
// first form (RFC 4291, 2.5.5.2); settings use the second.
static void take_off_mapping(char *address)
{
	static const char mapped[] = "::ffff:";
	struct in_addr found;
	char *inner = address + sizeof mapped - 1;
	if (strncmp(address, mapped, sizeof mapped - 1) == 0 && inet_pton(AF_INET, inner, &found) == 1)
		memmove(address, inner, strlen(inner) + 1);
}

// Each proxy appends its client's address to the header. So the addresses are read from the right.
// If an address belongs to a trusted proxy, that proxy wrote the address on the left, which is read
// next. The first address that is not a trusted proxy is the client. Anything on the left of the
// client's address may be forged.
void cau_auth_find_address(const cau_config *config, const char *forwarded, char *address,
                           size_t capacity)
{
	size_t end = forwarded ? strlen(forwarded) : 0;
	take_off_mapping(address);
	while (end > 0 && cau_list_has(config->trusted_proxies, address)) {
		char item[64];
		size_t start = end;
		while (start > 0 && forwarded[start - 1] != ',')
			start--;
		const char *first = forwarded + start + strspn(forwarded + start, " \t");
		size_t bytes = strcspn(first, " \t,");
		if (bytes == 0 || bytes >= sizeof item || bytes >= capacity)
			return;
		memcpy(item, first, bytes);
		item[bytes] = 0;
		if (!is_address(item))
			return;
		memcpy(address, item, bytes + 1);
		end = start ? start - 1 : 0;
	}
}
