// SPDX-License-Identifier: Apache-2.0
// Writes JSON into a caller's buffer: no allocation, numbers that read back to the same bits.
//
//     #include "cautery/json_writer.h"
//
//     // {"tick": 7, "time_s": 0.07}
//     static cau_status tell_time(uint64_t tick, double time_s, char *buffer, size_t capacity,
//                                 cau_error *error)
//     {
//         cau_json_writer writer;
//         cau_json_begin(&writer, buffer, capacity, 0);
//         cau_json_open(&writer, NULL, '{');
//         cau_json_unsigned(&writer, "tick", tick);
//         cau_json_number(&writer, "time_s", time_s);
//         cau_json_close(&writer);
//         return cau_json_end(&writer, NULL, error);
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/json_text.h"

#ifdef __cplusplus
extern "C" {
#endif

// A text that is being written. The members are for the functions below.
typedef struct cau_json_writer {
	char *buffer;    // borrowed until cau_json_end
	size_t capacity; // bytes of the buffer, the closing zero included
	size_t bytes;    // needed so far, without the closing zero; counts on past the capacity
	int32_t indent;  // spaces a level; 0: all on one line
	int32_t depth;   // open levels
	char closing[CAU_JSON_MAX_DEPTH];  // '}' or ']' of each open level
	bool occupied[CAU_JSON_MAX_DEPTH]; // whether the level has a value yet
	bool flat[CAU_JSON_MAX_DEPTH];     // whether the level stays on its line in spite of `indent`
	cau_status status;                 // the first failure
	const char *reason;                // of the first failure; borrowed
} cau_json_writer;

// Begins a text in `buffer`. `indent`: spaces a level; 0: all on one line.
void cau_json_begin(cau_json_writer *writer, char *buffer, size_t capacity, int32_t indent);

// `key` is the member's name inside an object and NULL inside an array or at the top.
// `bracket` is '{' or '['; '(' opens an array that stays on one line.
void cau_json_open(cau_json_writer *writer, const char *key, char bracket);
void cau_json_close(cau_json_writer *writer); // the innermost open level
void cau_json_number(cau_json_writer *writer, const char *key, double value); // must be finite
void cau_json_integer(cau_json_writer *writer, const char *key,
                      int64_t value); // below 2^53 in size
void cau_json_unsigned(cau_json_writer *writer, const char *key, uint64_t value);  // below 2^53
void cau_json_bool(cau_json_writer *writer, const char *key, bool value);          // true or false
void cau_json_null(cau_json_writer *writer, const char *key);                      // null
void cau_json_string(cau_json_writer *writer, const char *key, const char *value); // valid UTF-8
// An array of `count` finite numbers, on one line.
void cau_json_numbers(cau_json_writer *writer, const char *key, const double *value, int32_t count);
// Appends text that is JSON already (from another writer).
void cau_json_raw(cau_json_writer *writer, const char *key, const char *json, size_t bytes);

// Marks the text as not to be used; the first failure is the one that cau_json_end reports.
// `reason` is borrowed until then.
void cau_json_fail(cau_json_writer *writer, cau_status status, const char *reason);

// Ends the text with a zero byte. *bytes (may be NULL) is what the text needs without it, also when
// it did not fit. Errors: CAU_LIMIT (the buffer is too small), CAU_BAD_VALUE (a number or string
// that JSON cannot carry), CAU_BAD_STATE (levels left open or closed too often).
cau_status cau_json_end(cau_json_writer *writer, size_t *bytes, cau_error *error);

#ifdef __cplusplus
}
#endif
