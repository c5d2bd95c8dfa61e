// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for URLs. An accepted URL has a host and a port, and reading it back gives the same
// URL.
#include "fuzz/fuzz_target.h"

#include <stdlib.h>
#include <string.h>

#include "library/url.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	char text[512], again[600];
	cau_url url, url_again;
	cau_error error = {0};
	if (size >= sizeof text)
		return 0;
	memcpy(text, data, size);
	text[size] = 0;
	if (cau_url_read(text, &url, &error))
		return 0;
	bool brackets = strchr(url.host, ':');
	snprintf(again, sizeof again, brackets ? "%s://[%s]:%d" : "%s://%s:%d", url.tls ? "wss" : "ws",
	         url.host, url.port);
	if (!*url.host || url.port < 1 || url.port > 65535 || cau_url_read(again, &url_again, &error) ||
	    strcmp(url.host, url_again.host) != 0 || url.port != url_again.port ||
	    url.tls != url_again.tls)
		abort();
	return 0;
}
