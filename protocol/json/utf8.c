// SPDX-License-Identifier: Apache-2.0
#include "cautery/utf8.h"

#include <stdint.h>
#include <string.h>

#include "cautery/assert.h"

#define HIGH_BITS UINT64_C(0x8080808080808080) // these bits are set in bytes that are not ASCII

// Examines eight bytes at a time, because most texts are ASCII.
size_t cau_utf8_ascii(const char *text, size_t bytes)
{
	size_t at = 0;
	for (uint64_t word; bytes - at >= sizeof word; at += sizeof word) {
		memcpy(&word, text + at, sizeof word);
		if (word & HIGH_BITS)
			break;
	}
	while (at < bytes && (unsigned char)text[at] < 0x80)
		at++;
	return at;
}

// Sets the range of the second byte, which excludes overlong forms, surrogates and codes beyond
// U+10FFFF (RFC 3629, 4).
static void second_byte_range(unsigned char first, unsigned char *least, unsigned char *most)
{
	*least = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
	*most = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
}

// Returns the character's length from its first byte, or 0 if no character starts with that byte.
static size_t told_length(unsigned char first)
{
	if (first < 0x80)
		return 1;
	return first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
}

// True if the bytes after the first byte are allowed there.
static bool may_follow(const unsigned char *at, size_t bytes)
{
	CAU_ASSERT(bytes >= 1 && bytes <= 4, "a character of %zu bytes", bytes);
	unsigned char least, most;
	second_byte_range(at[0], &least, &most);
	if (bytes > 1 && (at[1] < least || at[1] > most))
		return false;
	for (size_t i = 2; i < bytes; i++)
		if ((at[i] & 0xC0) != 0x80)
			return false;
	return true;
}

size_t cau_utf8_length(const char *text, size_t bytes)
{
	const unsigned char *at = (const unsigned char *)text;
	size_t length = bytes ? told_length(at[0]) : 0;
	return length <= bytes && length && may_follow(at, length) ? length : 0;
}

bool cau_utf8_is_start(const char *text, size_t bytes)
{
	const unsigned char *at = (const unsigned char *)text;
	return bytes < told_length(at[0]) && may_follow(at, bytes);
}

size_t cau_utf8_encode(unsigned code, char out[4])
{
	CAU_ASSERT(code < 1u << 21, "code %x has more bits than four bytes hold", code);
	if (code < 0x80) {
		out[0] = (char)code;
		return 1;
	}
	size_t length = code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
	for (size_t i = length - 1; i > 0; i--, code >>= 6)
		out[i] = (char)(0x80 | (code & 0x3F));
	unsigned mark = length == 2 ? 0xC0 : length == 3 ? 0xE0 : 0xF0;
	out[0] = (char)(mark | code);
	return length;
}
