// SPDX-License-Identifier: Apache-2.0
// Writes JSON into a caller's buffer without allocation. Numbers read back with the same bits.
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

// A JSON text that is being written. The members are private.
typedef struct cau_json_writer {
	char *buffer;    // borrowed until cau_json_end
	size_t capacity; // bytes of the buffer, including the closing zero
	size_t bytes;    // bytes needed so far without the closing zero; may exceed the capacity
	int32_t indent;  // spaces a level; 0 for one line
	int32_t depth;   // number of open levels
	char closing[CAU_JSON_MAX_DEPTH];  // '}' or ']' of each open level
	bool occupied[CAU_JSON_MAX_DEPTH]; // the level has a value
	bool flat[CAU_JSON_MAX_DEPTH];     // the level stays on one line despite `indent`
	cau_status status;                 // the first failure
	char reason[240];                  // reason of the first failure
} cau_json_writer;

// Begins a text in `buffer`. `indent` is the number of spaces a level; 0 writes one line.
void cau_json_begin(cau_json_writer *writer, char *buffer, size_t capacity, int32_t indent);

// Opens an object or array. `key` is the member's name inside an object, and NULL inside an array
// or at the top level. `bracket` is '{' or '['; '(' opens an array that stays on one line.
void cau_json_open(cau_json_writer *writer, const char *key, char bracket);
void cau_json_close(cau_json_writer *writer); // closes the innermost open level
// Writes a number, which must be finite.
void cau_json_number(cau_json_writer *writer, const char *key, double value);
// Writes an integer with a magnitude below 2^53.
void cau_json_integer(cau_json_writer *writer, const char *key, int64_t value);
// Writes an integer below 2^53.
void cau_json_unsigned(cau_json_writer *writer, const char *key, uint64_t value);
// Writes true or false.
void cau_json_bool(cau_json_writer *writer, const char *key, bool value);
// Writes null.
void cau_json_null(cau_json_writer *writer, const char *key);
// Writes a string, which must be valid UTF-8.
void cau_json_string(cau_json_writer *writer, const char *key, const char *value);
// Writes an array of `count` finite numbers on one line.
void cau_json_numbers(cau_json_writer *writer, const char *key, const double *value, int32_t count);
// Appends a text that is already JSON.
void cau_json_raw(cau_json_writer *writer, const char *key, const char *json, size_t bytes);

// Marks the text as invalid. cau_json_end reports the first failure with its reason, a format of
// printf and its values, of which 239 bytes are kept.
__attribute__((format(printf, 3, 4))) void cau_json_fail(cau_json_writer *writer, cau_status status,
                                                         const char *reason, ...);

// Ends the text with a zero byte. *bytes (may be NULL) is the needed length without the zero, even
// if it did not fit. Errors: CAU_LIMIT (the buffer is too small), CAU_BAD_VALUE (a number or string
// that JSON cannot represent), CAU_BAD_STATE (levels left open or closed too often).
cau_status cau_json_end(cau_json_writer *writer, size_t *bytes, cau_error *error);

#ifdef __cplusplus
}
#endif
