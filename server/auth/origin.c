// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "auth/auth.h"
#include "auth/list.h"

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
