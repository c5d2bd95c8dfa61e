// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { CAU_SHA256_TEXT_BYTES = 65 };

// 64 lower-case hex digits and a zero. False if memory ran out.
bool cau_sha256(const void *bytes, size_t byte_count, char text[CAU_SHA256_TEXT_BYTES]);
