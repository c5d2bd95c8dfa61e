// SPDX-License-Identifier: GPL-3.0-or-later
#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>

#include "auth/auth.h"
#include "auth/list.h"

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
