// SPDX-License-Identifier: Apache-2.0
#include "cautery/command_json.h"

#include "json/document.h"
#include "json/fields.h"

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
		cau_json_fail(writer, CAU_BAD_VALUE, "the kind of the command does not exist");
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
