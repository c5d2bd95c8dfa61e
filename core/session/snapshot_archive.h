// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a snapshot's payload: the same walk over the state counts, writes and reads them.
#pragma once

#include <stddef.h>
#include <string.h>

#include "session/session_internal.h"

typedef struct snapshot_archive {
	unsigned char *bytes; // NULL: only counts
	size_t at, capacity;
	int reading;
	uint32_t version; // of what is read or written
} snapshot_archive;

static inline void snapshot_pass(snapshot_archive *archive, void *data, size_t bytes)
{
	if (archive->bytes && archive->at + bytes <= archive->capacity && bytes) {
		if (archive->reading)
			memcpy(data, archive->bytes + archive->at, bytes);
		else
			memcpy(archive->bytes + archive->at, data, bytes);
	}
	archive->at += bytes;
}

// snapshot_elements.c: what the elements' slots hold that changes. CAU_NO_MEMORY, when reading an
// older version, is the only failure.
cau_status cau_snapshot_pass_elements(snapshot_archive *archive, cau_session *session,
                                      cau_error *error);

// snapshot_tools.c: of a tool's state what versions before 6 had of it, which decides what follows;
// all of a tool.
void cau_snapshot_pass_tool_state(snapshot_archive *archive, cau_tool_state *state);
void cau_snapshot_pass_tool_def(snapshot_archive *archive, cau_tool_def *def);
void cau_snapshot_pass_tool(snapshot_archive *archive, cau_tool *tool);
// Since version 6: which of the holds of all tools are on faces, and where.
void cau_snapshot_pass_faces_held(snapshot_archive *archive, cau_session *session);

// snapshot_materials.c: materials as all versions have them; a command with those that it sets;
// and, since version 6, what materials bear and which elements are over it.
void cau_snapshot_pass_materials(snapshot_archive *archive, cau_sheet_material *sheet,
                                 cau_fat_material *fat, cau_link_material *link, int count);
void cau_snapshot_pass_command(snapshot_archive *archive, cau_command *command);
void cau_snapshot_pass_tears(snapshot_archive *archive, cau_session *session);
