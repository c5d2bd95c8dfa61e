// SPDX-License-Identifier: Apache-2.0
// Describes structs by tables. One table for each struct serves reading, writing, the check for
// unknown members and the documentation.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/json_writer.h"
#include "cautery/scene.h"
#include "json/value.h"

// The types of fields. Each comment is the C type of the struct member.
typedef enum cau_field_type {
	CAU_FIELD_NUMBER,   // double
	CAU_FIELD_INTEGER,  // int32_t
	CAU_FIELD_COUNT,    // uint64_t below 2^53
	CAU_FIELD_CHOICE,   // int, an index into names
	CAU_FIELD_FLAG,     // int32_t, 0 or 1
	CAU_FIELD_NAME,     // char[CAU_NAME_BYTES]
	CAU_FIELD_TEXT,     // char[CAU_TEXT_BYTES]
	CAU_FIELD_ROTATION, // double[4]
} cau_field_type;

typedef struct cau_choices {
	const char *const *names;
	int count;
} cau_choices;

typedef struct cau_field {
	const char *name;
	cau_field_type type;
	size_t offset; // offset of the member in the struct
	int32_t count; // for a NUMBER or INTEGER: 0 for a scalar, else the length of the array
	// smallest accepted length of an array; values beyond a shorter array stay unchanged. 0: the
	// length must be `count`
	int32_t least_count;
	double least, most;         // range of each NUMBER or INTEGER
	const cau_choices *choices; // words of a CHOICE
	unsigned kinds;             // bits of the kinds that have this field; 0 means all
	bool required;
	const char *unless; // name of another member, with which this field is optional; or NULL
	const char *unit, *meaning;
} cau_field;

typedef struct cau_record {
	const char *title;
	const cau_field *fields;
	int field_count;
	// names of the kinds, one for each bit of cau_field.kinds; fields[0] has the kind. NULL: no
	// kinds
	const cau_choices *kinds;
} cau_record;

// A struct to read or write. One JSON object may consist of several parts.
typedef struct cau_part {
	const cau_record *record;
	void *base;
	int kind; // kind of the struct, an index into the record's `kinds`; unused if the record has no
	          // kinds
} cau_part;

enum { CAU_MAX_PARTS = 6 };

// Reads the members of the parts. The values of absent members stay unchanged. A member that is
// neither of a part nor in `others` is an error.
void cau_read_parts(cau_reader *reader, const cJSON *object, const cau_part *parts, int part_count,
                    const char *const *others, int other_count);

// Reads the one member `field` of `object` into `base`.
void cau_read_field(cau_reader *reader, const cJSON *object, const cau_field *field, void *base);

// Writes all members of the parts into the open object.
void cau_write_parts(cau_json_writer *writer, const cau_part *parts, int part_count);

// True if records of this kind have the field.
bool cau_field_applies(const cau_field *field, int kind);
