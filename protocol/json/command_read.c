// SPDX-License-Identifier: Apache-2.0
#include "cautery/command_json.h"

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "json/document.h"
#include "json/fields.h"
#include "json/instrument.h"

// Reads the kind first, then fills a new material with the defaults of that kind of layer.
static void read_material_kind(cau_reader *reader, const cJSON *value, cau_command *command)
{
	cau_read_field(reader, value, &cau_material_record.fields[0], &command->as.material);
	int kind = command->as.material.kind;
	if (kind == CAU_LAYER_FASCIA || kind == CAU_LAYER_MEMBRANE)
		cau_default_sheet_material(&command->as.material.sheet, kind);
}

// Reads shape and sizes of a tool. Absent members are those of the named instrument.
static void read_tool(cau_reader *reader, const cJSON *value, cau_command *command)
{
	cau_tool_choice choice;
	cau_part parts[CAU_MAX_PARTS];
	int count = cau_command_parts(command, parts);
	CAU_ASSERT(count < CAU_MAX_PARTS, "%d parts, and the instrument", count);
	parts[count++] = (cau_part){&cau_instrument_record, &choice.names, 0};
	cau_begin_tool(reader, value, &command->as.definition, &choice);
	cau_read_parts(reader, value, parts, count, NULL, 0);
	cau_end_tool(reader, &command->as.definition, &choice);
}

static void read_members(cau_reader *reader, const cJSON *value, cau_command *command)
{
	static const char *const others[] = {"selection"};
	cau_part parts[CAU_MAX_PARTS];
	int count = cau_command_parts(command, parts);
	cau_selection *selection = cau_command_selection(command);
	cau_read_parts(reader, value, parts, count, others, selection ? 1 : 0);
	if (!selection || reader->status)
		return;
	size_t mark = cau_reader_enter(reader, "selection", 0);
	cau_read_selection(reader, cau_value_member(value, "selection"), selection);
	cau_reader_leave(reader, mark);
}

void cau_read_command(cau_reader *reader, const cJSON *value, cau_command *command)
{
	cau_default_command(command, 0);
	if (!cau_read_object(reader, value))
		return;
	cau_read_field(reader, value, &cau_command_record.fields[0], command);
	cau_default_command(command, command->kind);
	if (command->kind == CAU_COMMAND_SET_MATERIAL)
		read_material_kind(reader, value, command);
	bool tool =
		command->kind == CAU_COMMAND_TOOL_ADD || command->kind == CAU_COMMAND_TOOL_CONFIGURE;
	if (!reader->status && tool)
		read_tool(reader, value, command);
	else if (!reader->status)
		read_members(reader, value, command);
}

cau_status cau_command_from_json(const char *text, size_t bytes, cau_command *command,
                                 cau_error *error)
{
	cau_reader reader;
	cJSON *value;
	cau_status status = cau_value_parse(text, bytes, CAU_COMMAND_JSON_MAX_BYTES, &value, error);
	if (status)
		return status;
	cau_reader_begin(&reader, NULL, error);
	cau_read_command(&reader, value, command);
	cJSON_Delete(value);
	return reader.status;
}
