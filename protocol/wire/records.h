// SPDX-License-Identifier: Apache-2.0
// The sections of frames that are records: tool names, tools, statistics.
#pragma once

#include "cautery/stream.h"

enum {
	TOOL_RECORD_BYTES = 84,
	TOOL_ASKED_BYTES = 28,
	TOOL_JAW_BYTES = 8,
	TOOL_POWER_BYTES = 8,
	TOOL_FORCE_BYTES = 28,
	TOOL_NAMES_BYTES_MAX = 4 + CAU_MAX_TOOLS * (2 + CAU_NAME_BYTES) + 3,
	STATISTICS_RECORD_BYTES = 112,
	STATISTICS_LEAST_BYTES = 88, // without what comes after refused_commands, as servers began
};

// What a decoder would refuse in this tool, or NULL.
const char *cau_stream_tool_check(const cau_stream_tool *tool);

// Each writes a payload and returns its length.
size_t cau_tool_names_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
size_t cau_tools_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Poses that are asked; 0: none is another than the tool's.
size_t cau_tools_asked_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Jaws; 0: none presses, and all are as they are asked to be.
size_t cau_tool_jaws_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Power; 0: no generator gives any.
size_t cau_tool_power_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Raw forces and the filters' time constants; 0: there is no tool, or not all have a raw force.
size_t cau_tool_force_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
size_t cau_statistics_write(uint8_t *out, const cau_stream_statistics *statistics);

// Each reads a payload; returns NULL or what is wrong. tool_names_read keeps the rest of the
// records.
const char *cau_tool_names_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                int32_t *count);
const char *cau_tools_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                           int32_t count);
// These four after cau_tools_read, which takes all to be as it is asked to be, without power and
// without raw forces.
const char *cau_tools_asked_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                 int32_t count);
const char *cau_tool_jaws_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                               int32_t count);
const char *cau_tool_power_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                int32_t count);
const char *cau_tool_force_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                int32_t count);
const char *cau_statistics_read(const uint8_t *payload, size_t bytes,
                                cau_stream_statistics *statistics);
