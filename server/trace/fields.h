// SPDX-License-Identifier: GPL-3.0-or-later
// The members of the machine's structs that a trace has: one entry each, used for writing and for
// reading.
#pragma once

#include <stddef.h>

#include "trace/trace.h"

typedef enum field_kind {
	FIELD_UNSIGNED, // an unsigned integer of 4 or 8 bytes
	FIELD_SIGNED,   // a signed integer of 4 or 8 bytes
	FIELD_REAL,
	FIELD_TRUTH,
	FIELD_CHOICE, // an enum, written as words
	FIELD_TEXT    // an array of characters with a zero at its end
} field_kind;

typedef struct field {
	const char *name;
	field_kind kind;
	size_t offset, bytes;
	const char *const *words; // FIELD_CHOICE: one word for each value
	int32_t word_count;
} field;

typedef struct field_list {
	const field *fields;
	int32_t count;
} field_list;

extern const field_list cau_trace_call_fields;
extern const field_list cau_trace_action_fields; // of cau_action, without its drive
extern const field_list cau_trace_effect_fields; // of a cau_effect that refuses, without its drive
extern const field_list cau_trace_drive_fields;  // of cau_drive

extern const char *const cau_trace_what_words[CAU_TRACE_WHAT_COUNT];
extern const char *const cau_trace_effect_words[];
