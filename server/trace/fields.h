// SPDX-License-Identifier: GPL-3.0-or-later
// The members that a trace tells of the machine's structs: one row each, for writing and for
// reading.
#pragma once

#include <stddef.h>

#include "trace/trace.h"

typedef enum field_kind {
	FIELD_UNSIGNED, // of 4 or 8 bytes
	FIELD_SIGNED,   // likewise
	FIELD_REAL,
	FIELD_TRUTH,
	FIELD_CHOICE, // an enum, by its words
	FIELD_TEXT    // an array of characters that ends with a zero
} field_kind;

typedef struct field {
	const char *name;
	field_kind kind;
	size_t offset, bytes;
	const char *const *words; // FIELD_CHOICE: as many as it has values
	int32_t word_count;
} field;

typedef struct field_list {
	const field *fields;
	int32_t count;
} field_list;

extern const field_list cau_trace_call_fields;
extern const field_list cau_trace_action_fields; // of cau_action, but for its drive
extern const field_list cau_trace_effect_fields; // of cau_effect that refuses, but for its drive
extern const field_list cau_trace_drive_fields;  // of cau_drive

extern const char *const cau_trace_what_words[CAU_TRACE_WHAT_COUNT];
extern const char *const cau_trace_effect_words[];
