// SPDX-License-Identifier: Apache-2.0

#include <string.h>

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "json/document.h"
#include "json/record.h"

enum { PROFILE_BYTES = 1 << 16, INSTRUMENTS = 64, NUMBERS = 64 };

// Names of the members of a tool that a mode may set. Their ranges are those of a tool's members. A
// mode also has the range of its power.
static const char *const settings[] = {"power_w", "peak_v", "crest_factor", "current_max_a",
                                       "load_rise_off"};
enum { SETTINGS = sizeof settings / sizeof settings[0] };

// clang-format off: tables
#define STRUCT cau_choice_names
static const cau_field choice_fields[] = {
	{OTHER(
		instrument, NAME,
		"profile of an instrument (`deploy/instruments`), which gives the shape, the sizes and the "
		"settings that this object leaves out")},
	{OTHER(mode, NAME, "mode of the instrument (default: its first)")},
};
#undef STRUCT
RECORD(cau_instrument_record, "an instrument", choice_fields, NULL)

#define STRUCT cau_instrument
static const cau_field profile_fields[] = {
	{OTHER(name, NAME, "name of the profile, the same as that of its file"), .required = true},
	{OTHER(description, TEXT, "description of the instrument in words"), .required = true},
};
#undef STRUCT
static RECORD(profile_record, "a profile", profile_fields, NULL)

#define STRUCT cau_instrument_mode
	static const cau_field mode_fields[] = {
		{OTHER(name, NAME, "name of the mode"), .required = true},
		{OTHER(description, TEXT, "description of the mode in words"), .required = true},
		{SCALAR_OF(power_least_w, 0.0, 400.0, "W", "least power of the mode"), .required = true},
		{SCALAR_OF(power_most_w, 0.0, 400.0, "W", "largest power of the mode"), .required = true},
};
#undef STRUCT
static RECORD(mode_record, "a mode", mode_fields, NULL)
	// clang-format on

	// ---- sources

	// The limits of a range need no source, because the number inside the range has one.
	static bool has_source(const cJSON *member)
{
	return cJSON_IsNumber(member) && strcmp(member->string, "power_least_w") != 0 &&
	       strcmp(member->string, "power_most_w") != 0;
}

// Checks that each number in `numbers` has a text in the member `sources` of `object`, and that
// `sources` has no other members.
static void read_sources(cau_reader *reader, const cJSON *object, const cJSON *numbers)
{
	const char *names[NUMBERS];
	char text[CAU_TEXT_BYTES];
	int count = 0;
	const cJSON *sources = cau_value_member(object, "sources");
	size_t mark = cau_reader_enter(reader, "sources", 0);
	if (cau_read_object(reader, sources))
		for (const cJSON *number = numbers->child; number && count < NUMBERS;
		     number = number->next) {
			if (!has_source(number))
				continue;
			names[count++] = number->string;
			size_t inner = cau_reader_enter(reader, number->string, 0);
			cau_read_text(reader, cau_value_member(sources, number->string), text, sizeof text);
			if (!reader->status && !text[0])
				cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "a source is needed");
			cau_reader_leave(reader, inner);
		}
	if (!reader->status)
		cau_read_no_others(reader, sources, names, count);
	cau_reader_leave(reader, mark);
}

// ---- profiles -----------------------------------------------------------------------------------

static void read_setting(cau_reader *reader, const cJSON *object, const char *name,
                         cau_tool_def *tool)
{
	int i = 0;
	while (strcmp(cau_tool_record.fields[i].name, name) != 0)
		i++;
	CAU_ASSERT_INDEX(i, cau_tool_record.field_count);
	cau_read_field(reader, object, &cau_tool_record.fields[i], tool);
}

static void check_power(cau_reader *reader, const cau_tool_def *tool,
                        const cau_instrument_mode *mode)
{
	if (!reader->status &&
	    !(tool->power_w >= mode->power_least_w && tool->power_w <= mode->power_most_w))
		cau_reader_fail(reader, CAU_BAD_VALUE, "power_w",
		                "%g is not between %g and %g W, which the mode \"%s\" has", tool->power_w,
		                mode->power_least_w, mode->power_most_w, mode->name);
}

static void read_mode(cau_reader *reader, const cJSON *object, const cau_tool_def *tool,
                      cau_instrument_mode *mode)
{
	const char *others[SETTINGS + 1];
	memcpy(others, settings, sizeof settings);
	others[SETTINGS] = "sources";
	cau_part part = {&mode_record, mode, 0};
	mode->tool = *tool;
	if (!cau_read_object(reader, object))
		return;
	cau_read_parts(reader, object, &part, 1, others, SETTINGS + 1);
	for (int i = 0; i < SETTINGS; i++)
		read_setting(reader, object, settings[i], &mode->tool);
	if (!reader->status)
		read_sources(reader, object, object);
	check_power(reader, &mode->tool, mode);
}

static void read_tool(cau_reader *reader, const cJSON *object, cau_tool_def *tool)
{
	cau_part part = {&cau_tool_record, tool, 0};
	size_t mark = cau_reader_enter(reader, "tool", 0);
	if (cau_read_object(reader, object))
		cau_read_parts(reader, object, &part, 1, NULL, 0);
	cau_reader_leave(reader, mark);
}

static void read_profile(cau_reader *reader, const cJSON *value, const char *name,
                         cau_instrument *to)
{
	static const char *const others[] = {"tool", "sources", "modes"};
	cau_part part = {&profile_record, to, 0};
	cau_tool_def tool;
	cau_default_tool_def(&tool, 0);
	if (!cau_read_object(reader, value))
		return;
	cau_read_parts(reader, value, &part, 1, others, 3);
	if (!reader->status && strcmp(to->name, name) != 0)
		cau_reader_fail(reader, CAU_BAD_VALUE, "name", "\"%s\", in the file of \"%.60s\"", to->name,
		                name);
	read_tool(reader, cau_value_member(value, "tool"), &tool);
	if (!reader->status)
		read_sources(reader, value, cau_value_member(value, "tool"));
	const cJSON *modes = cau_value_member(value, "modes");
	size_t mark = cau_reader_enter(reader, "modes", 0);
	if (!reader->status && cau_read_array(reader, modes, 1, CAU_MAX_MODES))
		for (const cJSON *mode = modes->child; mode && !reader->status; mode = mode->next) {
			size_t inner = cau_reader_enter(reader, NULL, to->mode_count);
			CAU_ASSERT_INDEX(to->mode_count, CAU_MAX_MODES);
			read_mode(reader, mode, &tool, &to->modes[to->mode_count++]);
			cau_reader_leave(reader, inner);
		}
	cau_reader_leave(reader, mark);
}

cau_status cau_instrument_from_json(const char *name, const char *text, size_t bytes,
                                    cau_instrument *instrument, cau_error *error)
{
	cau_reader reader;
	cJSON *value;
	cau_status status = cau_value_parse(text, bytes, PROFILE_BYTES, &value, error);
	if (status)
		return status;
	memset(instrument, 0, sizeof *instrument);
	cau_reader_begin(&reader, NULL, error);
	read_profile(&reader, value, name, instrument);
	cJSON_Delete(value);
	return reader.status;
}

int32_t cau_instrument_count(void)
{
	CAU_ASSERT(cau_instrument_file_count <= INSTRUMENTS, "%d instruments",
	           cau_instrument_file_count);
	return cau_instrument_file_count;
}

const char *cau_instrument_name(int32_t index)
{
	CAU_ASSERT_INDEX(index, cau_instrument_count());
	return cau_instrument_files[index].name;
}

cau_status cau_instrument_read(int32_t index, cau_instrument *instrument, cau_error *error)
{
	CAU_ASSERT_INDEX(index, cau_instrument_count());
	const cau_instrument_file *file = &cau_instrument_files[index];
	return cau_instrument_from_json(file->name, file->text, file->bytes, instrument, error);
}

// ---- choosing an instrument ---------------------------------------------------------------------

static int read_instrument_name(cau_reader *reader, const cJSON *value)
{
	const char *names[INSTRUMENTS];
	int32_t count = cau_instrument_count();
	for (int32_t i = 0; i < count; i++)
		names[i] = cau_instrument_name(i);
	size_t mark = cau_reader_enter(reader, "instrument", 0);
	int index = cau_read_choice(reader, value, names, count);
	cau_reader_leave(reader, mark);
	return index;
}

static int read_mode_name(cau_reader *reader, const cJSON *value, const cau_instrument *instrument)
{
	const char *names[CAU_MAX_MODES];
	for (int32_t i = 0; i < instrument->mode_count; i++)
		names[i] = instrument->modes[i].name;
	size_t mark = cau_reader_enter(reader, "mode", 0);
	int index = value ? cau_read_choice(reader, value, names, instrument->mode_count) : 0;
	cau_reader_leave(reader, mark);
	return index;
}

static void take_mode(const cau_instrument_mode *mode, cau_tool_def *tool)
{
	cau_tool_def kept = *tool;
	*tool = mode->tool;
	memcpy(tool->name, kept.name, sizeof tool->name);
	tool->pose = kept.pose;
}

void cau_begin_tool(cau_reader *reader, const cJSON *object, cau_tool_def *tool,
                    cau_tool_choice *choice)
{
	cau_instrument instrument;
	cau_error error = {0};
	const cJSON *name = cau_value_member(object, "instrument");
	const cJSON *mode = cau_value_member(object, "mode");
	memset(choice, 0, sizeof *choice);
	if (!name && mode)
		cau_reader_fail(reader, CAU_BAD_VALUE, "mode",
		                "a mode needs the member instrument, which names the instrument");
	if (!name || reader->status)
		return;
	int index = read_instrument_name(reader, name);
	if (index < 0)
		return;
	if (cau_instrument_read(index, &instrument, &error)) {
		cau_reader_fail(reader, error.status, "instrument", "%.160s: %.120s", error.path,
		                error.reason);
		return;
	}
	index = read_mode_name(reader, mode, &instrument);
	if (index < 0)
		return;
	choice->chosen = true;
	choice->mode = instrument.modes[index];
	take_mode(&choice->mode, tool);
}

void cau_end_tool(cau_reader *reader, const cau_tool_def *tool, const cau_tool_choice *choice)
{
	if (choice->chosen)
		check_power(reader, tool, &choice->mode);
}

cau_status cau_instrument_take(const char *instrument, const char *mode, double power_w,
                               cau_tool_def *tool, cau_error *error)
{
	cau_reader reader;
	cau_tool_choice choice = {0};
	cau_tool_def wanted = *tool;
	cJSON *object = cJSON_CreateObject();
	bool made = object && cJSON_AddStringToObject(object, "instrument", instrument) &&
	            (!mode || !*mode || cJSON_AddStringToObject(object, "mode", mode));
	cau_reader_begin(&reader, NULL, error);
	if (made)
		cau_begin_tool(&reader, object, &wanted, &choice);
	else
		cau_reader_fail(&reader, CAU_NO_MEMORY, NULL, "no memory for an instrument");
	cJSON_Delete(object);
	if (!(power_w < 0))
		wanted.power_w = power_w;
	cau_end_tool(&reader, &wanted, &choice);
	if (!reader.status)
		*tool = wanted;
	return reader.status;
}
