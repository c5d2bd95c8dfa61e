// SPDX-License-Identifier: Apache-2.0
#include "cautery/sha256.h"

#include <openssl/evp.h>
#include <stdio.h>

bool cau_sha256(const void *bytes, size_t byte_count, char text[CAU_SHA256_TEXT_BYTES])
{
	unsigned char digest[EVP_MAX_MD_SIZE];
	unsigned length = 0;
	if (!EVP_Digest(bytes, byte_count, digest, &length, EVP_sha256(), NULL))
		return false;
	for (unsigned i = 0; i < length; i++)
		snprintf(text + 2 * i, 3, "%02x", digest[i]);
	return true;
}
