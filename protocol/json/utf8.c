// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/utf8.h"

// The second byte is what tells overlong forms, surrogates and codes beyond U+10FFFF (RFC 3629, 4).
static void second_byte_range(unsigned char first, unsigned char *least, unsigned char *most)
{
	*least = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
	*most = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
}

size_t cau_utf8_length(const char *text, size_t bytes)
{
	const unsigned char *at = (const unsigned char *)text;
	if (bytes == 0)
		return 0;
	if (at[0] < 0x80)
		return 1;
	size_t length = at[0] < 0xC2 ? 0 : at[0] < 0xE0 ? 2 : at[0] < 0xF0 ? 3 : at[0] < 0xF5 ? 4 : 0;
	if (length == 0 || length > bytes)
		return 0;
	unsigned char least, most;
	second_byte_range(at[0], &least, &most);
	if (at[1] < least || at[1] > most)
		return 0;
	for (size_t i = 2; i < length; i++)
		if ((at[i] & 0xC0) != 0x80)
			return 0;
	return length;
}

size_t cau_utf8_encode(unsigned code, char out[4])
{
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
