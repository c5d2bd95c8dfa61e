// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { CAU_CLIENT_HASH_BYTES = 65 };

// 64 lower-case hex digits and a zero. False: the library for it refused.
bool cau_client_hash(const void *bytes, size_t byte_count, char text[CAU_CLIENT_HASH_BYTES]);
