// SPDX-License-Identifier: GPL-3.0-or-later
#include "hub/move_seals.h"

#include <stdio.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/name.h"

bool cau_move_opens(const char *key, const char *lock)
{
	cau_move_hash hash;
	return cau_sha256(key, strlen(key), hash) && strcmp(hash, lock) == 0;
}

// The hash of three texts, each at most as long as a hash.
static bool hash_texts(const char *use, const char *first, const char *second, cau_move_hash hash)
{
	char text[3 * CAU_SHA256_TEXT_BYTES];
	int bytes = snprintf(text, sizeof text, "%s %s %s", use, first, second);
	CAU_ASSERT(bytes > 0 && (size_t)bytes < sizeof text, "%d bytes", bytes);
	return cau_sha256(text, (size_t)bytes, hash);
}

bool cau_move_release(const char *secret, const char *move, cau_move_hash release)
{
	return hash_texts("release", secret, move, release);
}

bool cau_move_seal(const char *before, const void *piece, size_t byte_count, cau_move_hash seal)
{
	cau_move_hash own;
	return cau_sha256(piece, byte_count, own) && hash_texts("seal", before, own, seal);
}

bool cau_move_receipt(const char *move, const char *seal, cau_move_hash receipt)
{
	return hash_texts("receipt", move, seal, receipt);
}
