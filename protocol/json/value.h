// SPDX-License-Identifier: Apache-2.0
// Typed, strict access to parsed JSON, for the readers of this folder. Only this header and the
// files that include it use cJSON.
#pragma once

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

// Scans the text strictly, then parses it. The caller deletes *value with cJSON_Delete. See
// cau_json_scan.
cau_status cau_value_parse(const char *text, size_t bytes, size_t bytes_max, cJSON **value,
                           cau_error *error);

// A reader keeps the first failure and skips the rest. So callers need to check `status` only at
// the end. `path` is the reader's position in the document.
typedef struct cau_reader {
	cau_status status;
	cau_error *error; // may be NULL; error->file stays unchanged
	char path[160];
} cau_reader;

void cau_reader_begin(cau_reader *reader, const char *path, cau_error *error);

// cau_reader_enter steps into member `key`, or into element `index` if key is NULL.
// cau_reader_leave steps back to *mark.
size_t cau_reader_enter(cau_reader *reader, const char *key, int32_t index);
void cau_reader_leave(cau_reader *reader, size_t mark);

// Fails at the present path, or at its member `key` if that is not NULL. Keeps the first failure.
__attribute__((format(printf, 4, 5))) cau_status
cau_reader_fail(cau_reader *reader, cau_status status, const char *key, const char *format, ...);

// Returns the member with this name (case matters), or NULL.
const cJSON *cau_value_member(const cJSON *object, const char *key);

// Describes a value for an error reason: "a string", "the number 3", "an array", ... Uses `buffer`.
const char *cau_value_describe(const cJSON *value, char *buffer, size_t bytes);

// Each function reads `value`, which is at the present path. A NULL value is a missing member and
// fails. `unit` may be "".
bool cau_read_object(cau_reader *reader, const cJSON *value); // fails if it is not an object
bool cau_read_array(cau_reader *reader, const cJSON *value, int32_t least, int32_t most);
double cau_read_number(cau_reader *reader, const cJSON *value, double least, double most,
                       const char *unit);
int64_t cau_read_integer(cau_reader *reader, const cJSON *value, int64_t least, int64_t most);
bool cau_read_bool(cau_reader *reader, const cJSON *value);
// Copies at most bytes - 1 bytes and a zero. A longer text fails.
void cau_read_text(cau_reader *reader, const cJSON *value, char *text, size_t bytes);
// Reads a name by CAU_NAME_RULE. `text` has CAU_NAME_BYTES.
void cau_read_name(cau_reader *reader, const cJSON *value, char *text);
// Returns the index of a string in `names`, or -1 after a failure. The error lists the names and
// suggests the nearest.
int cau_read_choice(cau_reader *reader, const cJSON *value, const char *const *names, int count);
// Reads a quaternion w, x, y, z. It must be within 1e-3 of unit length and is then normalised.
void cau_read_rotation(cau_reader *reader, const cJSON *value, double rotation[4]);

// Fails for the first member whose name is not in `names`, and suggests the nearest name.
void cau_read_no_others(cau_reader *reader, const cJSON *object, const char *const *names,
                        int count);
