// SPDX-License-Identifier: Apache-2.0
#include "wire/records.h"

#include <math.h>

#include "cautery/assert.h"
#include "cautery/name.h"
#include "wire/bytes.h"

enum {
	TOOL_ENERGIZED = 1 << 0,
	TOOL_GRASPING = 1 << 1,
	TOOL_FROZEN = 1 << 2,
	TOOL_SLIPPING = 1 << 3,
	STATISTICS_FLOATS = 2 + CAU_STREAM_STAGES + 2,
	STATISTICS_COUNTS = 10,
	// number of words in the record: floats, counts and six more
	STATISTICS_WORDS = STATISTICS_RECORD_BYTES / 4,
};
_Static_assert(sizeof(cau_stream_statistics) == STATISTICS_RECORD_BYTES &&
                   STATISTICS_FLOATS + STATISTICS_COUNTS + 6 == STATISTICS_WORDS,
               "the record lists every member of cau_stream_statistics");

size_t cau_tool_names_write(uint8_t *out, const cau_stream_tool *tools, int32_t count)
{
	uint8_t *at = out + 4;
	store_u32(out, (uint32_t)count);
	for (int32_t i = 0; i < count; i++) {
		size_t length = strlen(tools[i].name);
		*at++ = (uint8_t)tools[i].shape;
		*at++ = (uint8_t)length;
		memcpy(at, tools[i].name, length);
		at += length;
	}
	for (; (at - out) % 4; at++)
		*at = 0;
	return (size_t)(at - out);
}

const char *cau_tool_names_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                int32_t *count)
{
	uint32_t announced = bytes >= 4 ? load_u32(payload) : UINT32_MAX;
	_Static_assert(CAU_MAX_TOOLS == 8, "the message below names the limit");
	if (bytes < 4)
		return "the list of tools is shorter than its count of 4 bytes";
	if (announced > CAU_MAX_TOOLS)
		return "the list announces more than 8 tools";
	size_t at = 4;
	for (uint32_t i = 0; i < announced; i++) {
		if (bytes - at < 2 || bytes - at - 2 < payload[at + 1] || payload[at + 1] >= CAU_NAME_BYTES)
			return "the name of a tool is longer than its section, or longer than names may be";
		tools[i].shape = payload[at];
		size_t length = payload[at + 1];
		memcpy(tools[i].name, payload + at + 2, length);
		tools[i].name[length] = 0;
		if (tools[i].shape >= CAU_TOOL_SHAPE_COUNT || !cau_name_is_valid(tools[i].name))
			return "a tool has an unknown shape or an invalid name";
		at += 2 + length;
	}
	*count = (int32_t)announced;
	return round_up_4(at) == bytes ? NULL : "the list of tools has the wrong length";
}

static uint8_t *store_vector(uint8_t *at, const double *value, int count)
{
	for (int i = 0; i < count; i++, at += 4)
		store_f32(at, (float)value[i]);
	return at;
}

static void store_tool(uint8_t *at, const cau_stream_tool *tool)
{
	CAU_RULE_INDEX(tool->shape, CAU_TOOL_SHAPE_COUNT);
	CAU_RULE(tool->energy_off < CAU_ENERGY_OFF_COUNT, "reason %d for energy off", tool->energy_off);
	store_u64(at, tool->sequence);
	at = store_vector(at + 8, tool->pose.position_m, 3);
	at = store_vector(at, tool->pose.rotation, 4);
	at = store_vector(at, &tool->jaw, 1);
	at = store_vector(at, tool->force_n, 3);
	at = store_vector(at, tool->torque_nm, 3);
	at = store_vector(at, &tool->tip_temperature_c, 1);
	at = store_vector(at, &tool->energy_j, 1);
	store_u32(at, tool->driver);
	at[4] =
		(uint8_t)((tool->energized ? TOOL_ENERGIZED : 0) | (tool->grasping ? TOOL_GRASPING : 0) |
	              (tool->frozen ? TOOL_FROZEN : 0) | (tool->slipping ? TOOL_SLIPPING : 0));
	at[5] = tool->energy_off;
	store_u16(at + 6, tool->grasped_vertices);
	store_u16(at + 8, tool->contact_vertices);
	store_u16(at + 10, tool->touched_layers);
}

static bool is_finite(const double *value, int count)
{
	for (int i = 0; i < count; i++) {
		if (!isfinite((float)value[i]))
			return false;
	}
	return true;
}

const char *cau_stream_tool_check(const cau_stream_tool *tool)
{
	if (!memchr(tool->name, 0, sizeof tool->name) || !cau_name_is_valid(tool->name))
		return "its name breaks the rule " CAU_NAME_RULE;
	if (tool->shape < 0 || tool->shape >= CAU_TOOL_SHAPE_COUNT ||
	    tool->energy_off >= CAU_ENERGY_OFF_COUNT)
		return "the tool's shape, or its reason for energy off, has an unknown number";
	if (!is_finite(tool->pose.position_m, 3) || !is_finite(tool->pose.rotation, 4) ||
	    !is_finite(&tool->jaw, 1) || !is_finite(&tool->asked_jaw, 1) ||
	    !is_finite(&tool->jaw_force_n, 1) || !is_finite(&tool->delivered_w, 1) ||
	    !is_finite(&tool->load_ohm, 1) || !is_finite(tool->force_n, 3) ||
	    !is_finite(tool->torque_nm, 3) || !is_finite(&tool->tip_temperature_c, 1) ||
	    !is_finite(&tool->energy_j, 1) || !is_finite(tool->raw_force_n, 3) ||
	    !is_finite(tool->raw_torque_nm, 3) || !is_finite(&tool->force_filter_s, 1) ||
	    (tool->behind &&
	     (!is_finite(tool->asked_pose.position_m, 3) || !is_finite(tool->asked_pose.rotation, 4))))
		return "a number is not finite in single precision";
	return NULL;
}

size_t cau_tools_write(uint8_t *out, const cau_stream_tool *tools, int32_t count)
{
	CAU_RULE(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	for (int32_t i = 0; i < count; i++)
		store_tool(out + (size_t)i * TOOL_RECORD_BYTES, &tools[i]);
	return (size_t)count * TOOL_RECORD_BYTES;
}

size_t cau_tools_asked_write(uint8_t *out, const cau_stream_tool *tools, int32_t count)
{
	CAU_RULE(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool any = false;
	for (int32_t i = 0; i < count; i++)
		any = any || tools[i].behind;
	uint8_t *at = out;
	for (int32_t i = 0; i < count && any; i++) {
		const cau_pose *asked = tools[i].behind ? &tools[i].asked_pose : &tools[i].pose;
		at = store_vector(at, asked->position_m, 3);
		at = store_vector(at, asked->rotation, 4);
	}
	return (size_t)(at - out);
}

size_t cau_tool_jaws_write(uint8_t *out, const cau_stream_tool *tools, int32_t count)
{
	CAU_RULE(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool any = false;
	for (int32_t i = 0; i < count; i++)
		any = any || (float)tools[i].asked_jaw != (float)tools[i].jaw || tools[i].jaw_force_n > 0;
	uint8_t *at = out;
	for (int32_t i = 0; i < count && any; i++) {
		at = store_vector(at, &tools[i].asked_jaw, 1);
		at = store_vector(at, &tools[i].jaw_force_n, 1);
	}
	return (size_t)(at - out);
}

size_t cau_tool_power_write(uint8_t *out, const cau_stream_tool *tools, int32_t count)
{
	CAU_RULE(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool any = false;
	for (int32_t i = 0; i < count; i++)
		any = any || tools[i].delivered_w > 0 || tools[i].load_ohm > 0;
	uint8_t *at = out;
	for (int32_t i = 0; i < count && any; i++) {
		at = store_vector(at, &tools[i].delivered_w, 1);
		at = store_vector(at, &tools[i].load_ohm, 1);
	}
	return (size_t)(at - out);
}

size_t cau_tool_force_write(uint8_t *out, const cau_stream_tool *tools, int32_t count)
{
	CAU_RULE(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool all = true;
	for (int32_t i = 0; i < count; i++)
		all = all && tools[i].has_raw_force;
	uint8_t *at = out;
	for (int32_t i = 0; i < count && all; i++) {
		at = store_vector(at, tools[i].raw_force_n, 3);
		at = store_vector(at, tools[i].raw_torque_nm, 3);
		at = store_vector(at, &tools[i].force_filter_s, 1);
	}
	return (size_t)(at - out);
}

static const uint8_t *load_vector(const uint8_t *at, double *value, int count, bool *finite)
{
	for (int i = 0; i < count; i++, at += 4) {
		value[i] = (double)load_f32(at);
		*finite &= isfinite(value[i]) != 0;
	}
	return at;
}

static bool load_tool(const uint8_t *at, cau_stream_tool *tool)
{
	bool finite = true;
	tool->sequence = load_u64(at);
	at = load_vector(at + 8, tool->pose.position_m, 3, &finite);
	at = load_vector(at, tool->pose.rotation, 4, &finite);
	at = load_vector(at, &tool->jaw, 1, &finite);
	at = load_vector(at, tool->force_n, 3, &finite);
	at = load_vector(at, tool->torque_nm, 3, &finite);
	at = load_vector(at, &tool->tip_temperature_c, 1, &finite);
	at = load_vector(at, &tool->energy_j, 1, &finite);
	tool->behind = false;
	tool->asked_pose = tool->pose;
	tool->asked_jaw = tool->jaw;
	tool->jaw_force_n = tool->delivered_w = tool->load_ohm = tool->force_filter_s = 0;
	tool->has_raw_force = false;
	memset(tool->raw_force_n, 0, sizeof tool->raw_force_n);
	memset(tool->raw_torque_nm, 0, sizeof tool->raw_torque_nm);
	tool->driver = load_u32(at);
	tool->energized = at[4] & TOOL_ENERGIZED;
	tool->grasping = at[4] & TOOL_GRASPING;
	tool->frozen = at[4] & TOOL_FROZEN;
	tool->slipping = at[4] & TOOL_SLIPPING;
	tool->energy_off = at[5];
	tool->grasped_vertices = load_u16(at + 6);
	tool->contact_vertices = load_u16(at + 8);
	tool->touched_layers = load_u16(at + 10);
	return finite && tool->energy_off < CAU_ENERGY_OFF_COUNT;
}

const char *cau_tools_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                           int32_t count)
{
	CAU_ASSERT(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	if (bytes != (size_t)count * TOOL_RECORD_BYTES)
		return "the list of tools does not have one entry for each name";
	for (int32_t i = 0; i < count; i++) {
		if (!load_tool(payload + (size_t)i * TOOL_RECORD_BYTES, &tools[i]))
			return "a number of a tool is not finite, or its reason for energy off is unknown";
	}
	return NULL;
}

const char *cau_tools_asked_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                 int32_t count)
{
	CAU_ASSERT(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool finite = true;
	if (bytes != (size_t)count * TOOL_ASKED_BYTES)
		return "the list of commanded poses does not have one entry for each tool";
	for (int32_t i = 0; i < count; i++) {
		payload = load_vector(payload, tools[i].asked_pose.position_m, 3, &finite);
		payload = load_vector(payload, tools[i].asked_pose.rotation, 4, &finite);
		for (int c = 0; c < 3; c++)
			tools[i].behind |= tools[i].asked_pose.position_m[c] != tools[i].pose.position_m[c];
		for (int c = 0; c < 4; c++)
			tools[i].behind |= tools[i].asked_pose.rotation[c] != tools[i].pose.rotation[c];
	}
	return finite ? NULL : "a commanded pose is not finite";
}

const char *cau_tool_jaws_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                               int32_t count)
{
	CAU_ASSERT(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool finite = true;
	if (bytes != (size_t)count * TOOL_JAW_BYTES)
		return "the list of jaws does not have one entry for each tool";
	for (int32_t i = 0; i < count; i++) {
		payload = load_vector(payload, &tools[i].asked_jaw, 1, &finite);
		payload = load_vector(payload, &tools[i].jaw_force_n, 1, &finite);
	}
	return finite ? NULL : "a number in the list of jaws is not finite";
}

const char *cau_tool_power_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                int32_t count)
{
	CAU_ASSERT(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool finite = true;
	if (bytes != (size_t)count * TOOL_POWER_BYTES)
		return "the list of powers does not have one entry for each tool";
	for (int32_t i = 0; i < count; i++) {
		payload = load_vector(payload, &tools[i].delivered_w, 1, &finite);
		payload = load_vector(payload, &tools[i].load_ohm, 1, &finite);
	}
	return finite ? NULL : "a tool's power is not finite";
}

const char *cau_tool_force_read(const uint8_t *payload, size_t bytes, cau_stream_tool *tools,
                                int32_t count)
{
	CAU_ASSERT(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool finite = true;
	if (bytes != (size_t)count * TOOL_FORCE_BYTES)
		return "the list of raw forces does not have one entry for each tool";
	for (int32_t i = 0; i < count; i++) {
		tools[i].has_raw_force = true;
		payload = load_vector(payload, tools[i].raw_force_n, 3, &finite);
		payload = load_vector(payload, tools[i].raw_torque_nm, 3, &finite);
		payload = load_vector(payload, &tools[i].force_filter_s, 1, &finite);
	}
	return finite ? NULL : "a raw force is not finite";
}

static int is_float_word(size_t word)
{
	CAU_ASSERT_INDEX(word, STATISTICS_WORDS);
	// index of the first word after the counts: energy_gain_j, resting, error and three counts
	size_t beyond = STATISTICS_FLOATS + STATISTICS_COUNTS;
	return word < STATISTICS_FLOATS || word == beyond || word == beyond + 2;
}

// Writes the statistics. A statistic that is not finite, such as a rate over no time, is written as
// 0.
size_t cau_statistics_write(uint8_t *out, const cau_stream_statistics *statistics)
{
	uint32_t words[STATISTICS_WORDS];
	memcpy(words, statistics, sizeof words);
	for (size_t i = 0; i < STATISTICS_WORDS; i++) {
		store_u32(out + 4 * i, words[i]);
		if (is_float_word(i) && !isfinite(load_f32(out + 4 * i)))
			store_f32(out + 4 * i, 0.0f);
	}
	return STATISTICS_RECORD_BYTES;
}

const char *cau_statistics_read(const uint8_t *payload, size_t bytes,
                                cau_stream_statistics *statistics)
{
	uint32_t words[STATISTICS_WORDS] = {0};
	if (bytes < STATISTICS_LEAST_BYTES)
		return "the statistics are too short";
	for (size_t i = 0; i < STATISTICS_WORDS && 4 * i + 4 <= bytes; i++) {
		words[i] = load_u32(payload + 4 * i);
		if (is_float_word(i) && !isfinite(load_f32(payload + 4 * i)))
			return "a statistic is not finite";
	}
	memcpy(statistics, words, sizeof words);
	return NULL;
}
