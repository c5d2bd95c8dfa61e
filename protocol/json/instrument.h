// SPDX-License-Identifier: Apache-2.0
// Reads the members `instrument` and `mode` of the object that describes a tool.
#pragma once

#include "cautery/instrument.h"
#include "json/record.h"

typedef struct cau_choice_names {
	char instrument[CAU_NAME_BYTES], mode[CAU_NAME_BYTES];
} cau_choice_names;

typedef struct cau_tool_choice {
	cau_choice_names names; // the names in the object
	bool chosen;
	cau_instrument_mode mode; // the mode that the object names; only if `chosen`
} cau_tool_choice;

extern const cau_record cau_instrument_record; // cau_choice_names

// Call it before the members of a tool are read. It gives the tool the members of the instrument
// that `object` names.
void cau_begin_tool(cau_reader *reader, const cJSON *object, cau_tool_def *tool,
                    cau_tool_choice *choice);
// Call it after the members of a tool are read. It fails if the tool's power is outside the mode's
// range.
void cau_end_tool(cau_reader *reader, const cau_tool_def *tool, const cau_tool_choice *choice);

// A profile in the build. The profiles are sorted by name.
typedef struct cau_instrument_file {
	const char *name; // file name without its ending
	const char *text;
	size_t bytes;
} cau_instrument_file;

extern const cau_instrument_file cau_instrument_files[];
extern const int32_t cau_instrument_file_count;
