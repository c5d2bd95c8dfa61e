// SPDX-License-Identifier: Apache-2.0
#include <inttypes.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/command_json.h"

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
