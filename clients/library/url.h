// SPDX-License-Identifier: Apache-2.0
// The address of a daemon.
#pragma once

#include <stdbool.h>

#include "cautery/status.h"

typedef struct cau_url {
	char host[254];
	int port;
	bool tls;
} cau_url;

// Reads a URL: ws://, wss://, http:// or https://, a host or an IPv6 address in brackets, then
// optionally a port (default 8740, with TLS 443) and "/" or "/v1". Errors: CAU_BAD_VALUE.
cau_status cau_url_read(const char *text, cau_url *url, cau_error *error);
