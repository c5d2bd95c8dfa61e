// SPDX-License-Identifier: Apache-2.0
// Typed, strict access to parsed JSON for protocol's own readers. This header and the files that
// include it are the only places that know cJSON.
#pragma once

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

// Scans strictly, then parses. The caller deletes *value with cJSON_Delete. See cau_json_scan.
cau_status cau_value_parse(const char *text, size_t bytes, size_t bytes_max, cJSON **value,
                           cau_error *error);

// The first failure is kept and the rest skipped, so readers read straight on and ask for `status`
// at the end. `path` is where in the document the reader stands.
typedef struct cau_reader {
	cau_status status;
	cau_error *error; // may be NULL; error->file is kept
	char path[160];
} cau_reader;

void cau_reader_begin(cau_reader *reader, const char *path, cau_error *error);

// Steps into member `key` (or element `index` if key is NULL) and back. *mark remembers the way.
size_t cau_reader_enter(cau_reader *reader, const char *key, int32_t index);
void cau_reader_leave(cau_reader *reader, size_t mark);

// Fails at the present path, or at its member `key` if that is not NULL. Keeps the first failure.
__attribute__((format(printf, 4, 5))) cau_status
cau_reader_fail(cau_reader *reader, cau_status status, const char *key, const char *format, ...);

// The member of that name (case matters) or NULL.
const cJSON *cau_value_member(const cJSON *object, const char *key);

// "a string", "the number 3", "an array", ...: what stands there, for reasons. Uses `buffer`.
const char *cau_value_describe(const cJSON *value, char *buffer, size_t bytes);

// Each reads `value`, which stands at the present path; a NULL value fails as missing. `unit` may
// be "".
bool cau_read_object(cau_reader *reader, const cJSON *value); // fails if it is none
bool cau_read_array(cau_reader *reader, const cJSON *value, int32_t least, int32_t most);
double cau_read_number(cau_reader *reader, const cJSON *value, double least, double most,
                       const char *unit);
int64_t cau_read_integer(cau_reader *reader, const cJSON *value, int64_t least, int64_t most);
bool cau_read_bool(cau_reader *reader, const cJSON *value);
// Copies at most bytes - 1 bytes and a zero; longer text fails.
void cau_read_text(cau_reader *reader, const cJSON *value, char *text, size_t bytes);
// A name after CAU_NAME_RULE; `text` holds CAU_NAME_BYTES.
void cau_read_name(cau_reader *reader, const cJSON *value, char *text);
// The index of a string in `names`; -1 after a failure, which lists them and suggests the nearest.
int cau_read_choice(cau_reader *reader, const cJSON *value, const char *const *names, int count);
// A quaternion w, x, y, z: within 1e-3 of unit length, then normalised.
void cau_read_rotation(cau_reader *reader, const cJSON *value, double rotation[4]);

// Fails for the first member whose name is not among `names`, suggesting the nearest that is.
void cau_read_no_others(cau_reader *reader, const cJSON *object, const char *const *names,
                        int count);
