// SPDX-License-Identifier: Apache-2.0
// Checks JSON texts strictly by RFC 8259. An accepted text means the same to every JSON reader.
//
//     #include <stdbool.h>
//
//     #include "cautery/json_text.h"
//
//     enum { LARGEST = 65536 };
//
//     static bool is_json(const char *text, size_t bytes)
//     {
//         return cau_json_scan(text, bytes, LARGEST, NULL) == CAU_OK;
//     }
#pragma once

#include <stddef.h>

#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
	CAU_JSON_MAX_DEPTH = 64,        // largest depth of nested arrays and objects
	CAU_JSON_MAX_MEMBERS = 256,     // largest number of members of one object
	CAU_JSON_MAX_OPEN_KEYS = 1024,  // largest number of members of all open objects together
	CAU_JSON_MAX_KEY_BYTES = 64,    // largest size of a member's name, without the quotes
	CAU_JSON_MAX_NUMBER_BYTES = 63, // largest length of a number; cJSON reads no more bytes
};

// Accepts exactly one JSON value of at most `bytes_max` bytes, in valid UTF-8, with optional white
// space around it. It also refuses texts on which readers disagree: repeated keys (compared after
// their escapes are resolved), \u0000 and lone surrogates in strings, numbers that overflow a
// double, integers beyond 2^53, and texts beyond the limits above. Allocates nothing. Errors:
// CAU_BAD_SYNTAX, CAU_LIMIT; the reason starts "line 3, column 7 (byte 42): ". Lines and columns
// are counted from 1 (columns in bytes), bytes from 0.
cau_status cau_json_scan(const char *text, size_t bytes, size_t bytes_max, cau_error *error);

#ifdef __cplusplus
}
#endif
