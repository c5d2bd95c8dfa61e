// SPDX-License-Identifier: Apache-2.0
// Checks and writes UTF-8 by RFC 3629, which allows no overlong forms, no surrogates and nothing
// beyond U+10FFFF.
//
//     #include "cautery/utf8.h"
//
//     static bool is_utf8(const char *text, size_t bytes)
//     {
//         for (size_t at = 0, length; at < bytes; at += length)
//             if (!(length = cau_utf8_length(text + at, bytes - at)))
//                 return false;
//         return true;
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

// Returns the number of ASCII bytes at the start of `text`, 0 to `bytes`. Each is a whole
// character.
size_t cau_utf8_ascii(const char *text, size_t bytes);

// Returns the length of the valid character at the start of `text` (1 to 4), or 0 if there is none.
size_t cau_utf8_length(const char *text, size_t bytes);

// True if `text` (at least one byte) is the beginning of a valid character that is not complete.
bool cau_utf8_is_start(const char *text, size_t bytes);

// Writes `code` (not a surrogate, at most 0x10FFFF) to out[4]. Returns the number of bytes.
size_t cau_utf8_encode(unsigned code, char out[4]);

#ifdef __cplusplus
}
#endif
