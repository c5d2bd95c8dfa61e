// SPDX-License-Identifier: Apache-2.0
// Writes and reads the sections of frames that consist of records: tool names, tools, statistics,
// vessels and contacts of tools.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "cautery/channels.h"
#include "cautery/stream.h"

// ---- tools and statistics
enum {
	TOOL_RECORD_BYTES = 84,
	TOOL_ASKED_BYTES = 28,
	TOOL_JAW_BYTES = 8,
	TOOL_POWER_BYTES = 8,
	TOOL_FORCE_BYTES = 28,
	TOOL_NAMES_BYTES_MAX = 4 + CAU_MAX_TOOLS * (2 + CAU_NAME_BYTES) + 3,
	STATISTICS_RECORD_BYTES = 112,
	// smallest size of the record: the first servers sent no member after `refused_commands`
	STATISTICS_LEAST_BYTES = 88,
};

// Returns why a decoder would refuse this tool, or NULL.
const char *cau_stream_tool_check(const cau_stream_tool *tool);

// Each function writes a payload and returns its length.
size_t cau_tool_names_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
size_t cau_tools_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Writes commanded poses. Returns 0 if every commanded pose is the tool's actual pose.
size_t cau_tools_asked_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Writes jaws. Returns 0 if no jaws press and all jaws are as commanded.
size_t cau_tool_jaws_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Writes power. Returns 0 if no generator delivers power.
size_t cau_tool_power_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
// Writes raw forces and the filters' time constants. Returns 0 if there is no tool, or if some tool
// has no raw force.
size_t cau_tool_force_write(uint8_t *out, const cau_stream_tool *tools, int32_t count);
size_t cau_statistics_write(uint8_t *out, const cau_stream_statistics *statistics);

// Each function reads a payload and returns NULL, or the error in words. cau_tool_names_read keeps
// the other members of the tools.
const char *cau_tool_names_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                int32_t *count);
const char *cau_tools_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                           int32_t count);
// Call these four after cau_tools_read. It assumes that all poses and jaws are as commanded,
// without power and without raw forces.
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

// ---- vessels
enum { VESSELS_BYTES_MAX = 9 << 10 };

// Returns why a decoder would refuse this vessel, or NULL.
const char *cau_vessel_state_check(const cau_vessel_state *vessel);

// Writes the payload and returns its length, VESSELS_BYTES_MAX at most.
size_t cau_vessels_write(uint8_t *out, const cau_vessel_state *vessels, int32_t count);
// Reads a payload. Returns NULL, or why it is refused.
const char *cau_vessels_read(const uint8_t *payload, size_t bytes, cau_vessel_state *vessels,
                             int32_t *count);

// ---- contacts of tools
enum { CONTACTS_BYTES_MAX = 3 << 10 };

// Returns why a decoder would refuse this record, or NULL.
const char *cau_tool_contact_check(const cau_tool_contact *contact);

// Writes the payload and returns its length, CONTACTS_BYTES_MAX at most.
size_t cau_contacts_write(uint8_t *out, const cau_tool_contact *contacts, int32_t count);
// Reads a payload except time_s, which the frame's header has. Returns NULL, or why it is refused.
const char *cau_contacts_read(const uint8_t *payload, size_t bytes, cau_tool_contact *contacts,
                              int32_t *count);
