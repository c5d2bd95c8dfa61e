// SPDX-License-Identifier: Apache-2.0
// The hash by which files that travel in chunks are checked, and identities are told apart.
//
//     #include <string.h>
//
//     #include "cautery/sha256.h"
//
//     static bool is_whole(const void *file, size_t bytes, const char *told)
//     {
//         char hash[CAU_SHA256_TEXT_BYTES];
//         return cau_sha256(file, bytes, hash) && strcmp(hash, told) == 0;
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { CAU_SHA256_TEXT_BYTES = 65 };

// 64 lower-case hex digits and a zero (FIPS 180-4). False if memory ran out.
bool cau_sha256(const void *bytes, size_t byte_count, char text[CAU_SHA256_TEXT_BYTES]);
