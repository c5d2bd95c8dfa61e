// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a snapshot's payload: the same walk over the state counts, writes and reads them.
#pragma once

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
