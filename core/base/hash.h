// SPDX-License-Identifier: GPL-3.0-or-later
// A 64-bit hash for state comparison (FNV-1a over 8-byte words with a final mix). Not for security.
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { CAU_HASH_SHIFT = 29 };
#define CAU_HASH_START 0xcbf29ce484222325ull

static inline uint64_t cau_hash_word(uint64_t hash, uint64_t word)
{
	hash = (hash ^ word) * 0x9e3779b97f4a7c15ull;
	return hash ^ (hash >> CAU_HASH_SHIFT);
}

static inline uint64_t cau_hash_bytes(uint64_t hash, const void *bytes, size_t count)
{
	const unsigned char *cursor = bytes;
	for (; count >= 8; count -= 8, cursor += 8) {
		uint64_t word;
		memcpy(&word, cursor, 8);
		hash = cau_hash_word(hash, word);
	}
	uint64_t tail = count;
	for (size_t i = 0; i < count; i++)
		tail = tail << 8 | cursor[i];
	return cau_hash_word(hash, tail);
}
