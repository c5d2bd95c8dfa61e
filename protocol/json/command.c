// SPDX-License-Identifier: Apache-2.0
// Reads and writes commands, and reads scripts of commands.
#include "cautery/command_json.h"

#include <inttypes.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "json/document.h"

// ---- reading
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

// ---- writing
static bool kinds_exist(const cau_command *command)
{
	if (command->kind < 0 || command->kind >= CAU_COMMAND_COUNT)
		return false;
	return command->kind != CAU_COMMAND_SET_MATERIAL ||
	       (command->as.material.kind >= 0 && command->as.material.kind < CAU_LAYER_COUNT);
}

void cau_write_command(cau_json_writer *writer, const char *key, const cau_command *command)
{
	cau_part parts[CAU_MAX_PARTS];
	// A part's base is not const, but writing does not change it.
	cau_command *shared = (cau_command *)command;
	if (!kinds_exist(command)) {
		bool layer = command->kind == CAU_COMMAND_SET_MATERIAL;
		cau_json_fail(writer, CAU_BAD_VALUE, "%s is %d, not 0 to %d",
		              layer ? "the kind of the material's layer" : "the kind of the command",
		              layer ? (int)command->as.material.kind : (int)command->kind,
		              layer ? CAU_LAYER_COUNT - 1 : CAU_COMMAND_COUNT - 1);
		return;
	}
	cau_json_open(writer, key, '{');
	cau_write_parts(writer, parts, cau_command_parts_to_write(shared, parts));
	const cau_selection *selection = cau_command_selection(shared);
	if (selection)
		cau_write_selection(writer, "selection", selection);
	cau_json_close(writer);
}

cau_status cau_command_to_json(const cau_command *command, char *buffer, size_t capacity,
                               size_t *bytes, cau_error *error)
{
	cau_json_writer writer;
	cau_json_begin(&writer, buffer, capacity, 0);
	cau_write_command(&writer, NULL, command);
	return cau_json_end(&writer, bytes, error);
}

// ---- scripts
void cau_script_begin(cau_script *script, const char *name, const char *text, size_t bytes)
{
	*script = (cau_script){.name = name, .text = text, .bytes = bytes};
}

static bool is_blank(const char *line, size_t bytes)
{
	for (size_t i = 0; i < bytes; i++)
		if (line[i] != ' ' && line[i] != '\t' && line[i] != '\r')
			return false;
	return true;
}

// Finds the next line that is not blank. Returns false at the end of the text.
static bool next_line(cau_script *script, const char **line, size_t *bytes)
{
	CAU_ASSERT(script->offset <= script->bytes, "byte %zu of %zu", script->offset, script->bytes);
	while (script->offset < script->bytes) {
		*line = script->text + script->offset;
		size_t left = script->bytes - script->offset;
		const char *end = memchr(*line, '\n', left);
		*bytes = end ? (size_t)(end - *line) : left;
		script->offset += *bytes + (end != NULL);
		script->line++;
		if (!is_blank(*line, *bytes))
			return true;
	}
	return false;
}

static cau_status fail_line(const cau_script *script, cau_error *error)
{
	CAU_ASSERT(error->status != CAU_OK, "line %d fails without a reason", script->line);
	char reason[sizeof error->reason];
	snprintf(reason, sizeof reason, "%s", error->reason);
	snprintf(error->reason, sizeof error->reason, "script line %d: %.280s", script->line, reason);
	return error->status;
}

cau_status cau_script_next(cau_script *script, cau_command *command, bool *end, cau_error *error)
{
	cau_error local = {0};
	const char *line;
	size_t bytes;
	if (!error)
		error = &local;
	snprintf(error->file, sizeof error->file, "%s", script->name ? script->name : "");
	*end = !next_line(script, &line, &bytes);
	if (*end)
		return CAU_OK;
	cau_command read;
	if (cau_command_from_json(line, bytes, &read, error))
		return fail_line(script, error);
	if (read.tick < script->tick) {
		cau_fail(error, CAU_BAD_VALUE, "tick", "%" PRIu64 " after %" PRIu64 ": ticks never fall",
		         read.tick, script->tick);
		return fail_line(script, error);
	}
	script->tick = read.tick;
	*command = read;
	return CAU_OK;
}
