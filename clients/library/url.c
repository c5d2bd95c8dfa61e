// SPDX-License-Identifier: Apache-2.0
#include "library/url.h"

#include <stdlib.h>
#include <string.h>

enum { DEFAULT_PORT = 8740, DEFAULT_TLS_PORT = 443 };

static const struct {
	const char *prefix;
	bool tls;
} schemes[] = {{"ws://", false}, {"http://", false}, {"wss://", true}, {"https://", true}};

static cau_status refuse(const char *text, const char *reason, cau_error *error)
{
	return cau_fail(error, CAU_BAD_VALUE, "url", "`%.120s`: %s", text, reason);
}

// True if the host has only the characters of a host name or address. Other characters would be
// copied into the header of the request.
static bool is_host(const char *host, size_t bytes, bool bracketed)
{
	static const char taken[] =
		"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_%:";
	size_t fit = strspn(host, taken);
	return fit >= bytes && (bracketed || !memchr(host, ':', bytes));
}

// Finds the host without brackets and sets *bytes to its length. *end is the text after the host.
// Returns NULL if there is none.
static const char *find_host(const char *at, size_t *bytes, const char **end)
{
	const char *host = at;
	if (*at == '[') {
		host = at + 1;
		*bytes = strcspn(host, "]");
		*end = host + *bytes + (host[*bytes] == ']');
		return host[*bytes] == ']' ? host : NULL;
	}
	*bytes = strcspn(host, ":/?#@");
	*end = host + *bytes;
	return host;
}

cau_status cau_url_read(const char *text, cau_url *url, cau_error *error)
{
	const char *at = NULL, *end = NULL;
	size_t bytes = 0;
	*url = (cau_url){0};
	for (size_t i = 0; !at && i < sizeof schemes / sizeof *schemes; i++)
		if (strncmp(text, schemes[i].prefix, strlen(schemes[i].prefix)) == 0) {
			at = text + strlen(schemes[i].prefix);
			url->tls = schemes[i].tls;
		}
	if (!at)
		return refuse(text, "does not start with ws://, wss://, http:// or https://", error);
	const char *host = find_host(at, &bytes, &end);
	if (!host || bytes == 0 || bytes >= sizeof url->host)
		return refuse(text, "the address has no host", error);
	if (!is_host(host, bytes, host[-1] == '['))
		return refuse(text, "the host has invalid characters", error);
	memcpy(url->host, host, bytes);
	url->port = url->tls ? DEFAULT_TLS_PORT : DEFAULT_PORT;
	if (*end == ':') {
		char *after;
		long port = strtol(end + 1, &after, 10);
		if (after == end + 1 || end[1] < '0' || end[1] > '9' || port < 1 || port > 65535)
			return refuse(text, "the port is not within 1 to 65535", error);
		url->port = (int)port;
		end = after;
	}
	if (strcmp(end, "") != 0 && strcmp(end, "/") != 0 && strcmp(end, "/v1") != 0)
		return refuse(text, "only /v1 may follow host and port; give the session as an argument",
		              error);
	return CAU_OK;
}
