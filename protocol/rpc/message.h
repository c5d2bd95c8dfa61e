// SPDX-License-Identifier: Apache-2.0
// Messages: messages.def as data, for reading, checking, writing and describing messages, and the
// functions that read objects of messages.def from parsed JSON and write them as JSON.
#pragma once

#include "cautery/messages.h"
#include "json/record.h"

// ---- messages.def as data
typedef enum cau_wire_type {
	CAU_WIRE_TYPE_FLAG,
	CAU_WIRE_TYPE_INTEGER,
	CAU_WIRE_TYPE_NUMBER,
	CAU_WIRE_TYPE_VECTOR,
	CAU_WIRE_TYPE_TEXT,
	CAU_WIRE_TYPE_NAME,
	CAU_WIRE_TYPE_HEX64,
	CAU_WIRE_TYPE_CHOICE,
	CAU_WIRE_TYPE_CHOICES,
	CAU_WIRE_TYPE_PART,
	CAU_WIRE_TYPE_LIST,
	CAU_WIRE_TYPE_NUMBERS,
	CAU_WIRE_TYPE_INTEGERS,
	CAU_WIRE_TYPE_SCENE,
} cau_wire_type;

typedef struct cau_wire_field {
	const char *name;
	const char *unit, *meaning;
	double least, most;         // range of an INTEGER, NUMBER, VECTOR, NUMBERS or INTEGERS
	const cau_choices *choices; // words of a CHOICE or CHOICES
	size_t offset;              // offset of the member in the C type
	size_t has_offset;          // offset of the bool has_<name>, if the member is optional
	cau_wire_type type;
	cau_wire_object object; // type of a PART, or of a LIST's items
	int32_t count;          // VECTOR: length; TEXT: most bytes; LIST, NUMBERS, INTEGERS: most items
	bool required;
} cau_wire_field;

enum { CAU_WIRE_FIELDS_MAX = 32 };

typedef struct cau_wire_shape {
	const char *name;
	const char *meaning;
	size_t bytes; // size of the C type
	const cau_wire_field *fields;
	int32_t field_count;
} cau_wire_shape;

extern const cau_wire_shape cau_wire_shapes[CAU_WIRE_OBJECT_COUNT];

// ---- reading and writing
// Fills `to`, the C type of `object`, from the JSON object `value` at the reader's path. `strict`
// refuses members that are not in the table.
void cau_read_message(cau_reader *reader, const cJSON *value, cau_wire_object object, void *to,
                      bool strict);

// Refuses members that are not in the table of `object`.
void cau_refuse_unknown(cau_reader *reader, const cJSON *value, cau_wire_object object);

// Writes `from`, the C type of `object`. A value out of its range makes `place` fail, with the path
// of the value.
void cau_write_message(cau_json_writer *writer, const char *key, cau_wire_object object,
                       const void *from, cau_reader *place);
