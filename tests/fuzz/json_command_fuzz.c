// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for scripts. Every accepted command can be written, and reading the text gives the
// same command.
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "fuzz/fuzz_target.h"

static void check_command(const cau_command *command)
{
	cau_command again;
	cau_error error;
	char text[CAU_COMMAND_JSON_MAX_BYTES];
	size_t written = 0;
	if (cau_command_to_json(command, text, sizeof text, &written, &error) ||
	    cau_command_from_json(text, written, &again, &error) ||
	    memcmp(command, &again, sizeof again) != 0)
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	cau_script script;
	cau_script_begin(&script, "fuzz", (const char *)data, bytes);
	for (bool end = false; !end;) {
		cau_command command;
		cau_error error = {0};
		cau_status status = cau_script_next(&script, &command, &end, &error);
		if (status && (end || error.reason[0] == 0))
			abort();
		if (!status && !end)
			check_command(&command);
	}
	return 0;
}
