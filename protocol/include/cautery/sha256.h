// SPDX-License-Identifier: Apache-2.0
// Computes SHA-256. The hash checks files that are sent in chunks, and distinguishes identities.
//
//     #include <string.h>
//
//     #include "cautery/sha256.h"
//
//     static bool is_whole(const void *file, size_t bytes, const char *wanted)
//     {
//         char hash[CAU_SHA256_TEXT_BYTES];
//         return cau_sha256(file, bytes, hash) && strcmp(hash, wanted) == 0;
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CAU_SHA256_TEXT_BYTES = 65 }; // size of the hash as text, with its zero

// Writes the hash as 64 lower-case hex digits and a zero (FIPS 180-4). Returns false if memory ran
// out.
bool cau_sha256(const void *bytes, size_t byte_count, char text[CAU_SHA256_TEXT_BYTES]);

#ifdef __cplusplus
}
#endif
