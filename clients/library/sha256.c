// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/sha256.h"

#include <openssl/evp.h>
#include <stdio.h>

bool cau_client_hash(const void *bytes, size_t byte_count, char text[CAU_CLIENT_HASH_BYTES])
{
	unsigned char digest[EVP_MAX_MD_SIZE];
	unsigned length = 0;
	if (!EVP_Digest(bytes, byte_count, digest, &length, EVP_sha256(), NULL))
		return false;
	for (unsigned i = 0; i < length; i++)
		snprintf(text + 2 * i, 3, "%02x", digest[i]);
	return true;
}
