// SPDX-License-Identifier: Apache-2.0
// Reads tokens from files. Every user of the machine could read a token on a command line.
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "cautery/client.h"

cau_status cau_client_read_token(const char *file, char token[CAU_CLIENT_TOKEN_BYTES],
                                 cau_error *error)
{
	*token = 0;
	snprintf(error->file, sizeof error->file, "%.255s", file);
	FILE *stream = fopen(file, "re");
	if (!stream)
		return cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
	if (!fgets(token, CAU_CLIENT_TOKEN_BYTES, stream))
		*token = 0;
	fclose(stream);
	token[strcspn(token, "\r\n")] = 0;
	if (!*token)
		return cau_fail(error, CAU_BAD_VALUE, NULL, "the first line of the file has no token");
	*error->file = 0;
	return CAU_OK;
}
