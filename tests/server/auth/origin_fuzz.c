// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes the Host and Origin headers: an origin that is accepted must have an allowed host.
#include <stdlib.h>
#include <string.h>

#include "auth/auth.h"
#include "fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	cau_config config;
	char *text = malloc(size + 1);
	if (!text)
		return 0;
	memcpy(text, data, size);
	text[size] = 0;
	cau_config_default(&config);
	char *origin = strchr(text, '\n');
	if (origin)
		*origin++ = 0;
	if (cau_auth_host_allowed(&config, text) && cau_auth_origin_allowed(&config, origin, text) &&
	    origin && *origin && !strcasestr(origin, text))
		abort();
	free(text);
	return 0;
}
