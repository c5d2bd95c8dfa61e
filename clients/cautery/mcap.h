// SPDX-License-Identifier: GPL-3.0-or-later
// An MCAP file (mcap.dev/spec) of one channel: foxglove.SceneUpdate as JSON, on the topic "/scene".
// Each message is a chunk of its own, not compressed, so that readers can go to any time without
// reading the rest; its summary has the index and the statistics. A file that was never closed
// lacks the summary and can still be read from its beginning.
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "cautery/status.h"

typedef struct cli_mcap_chunk cli_mcap_chunk;

typedef struct cli_mcap {
	FILE *file;
	uint64_t bytes; // written so far
	uint32_t messages;
	cli_mcap_chunk *chunks; // (messages), for the summary
	uint32_t capacity;
} cli_mcap;

// The schema of messages: foxglove.SceneUpdate in JSON Schema, in pieces, the last one NULL.
extern const char *const cli_mcap_schema[];

// Errors: CAU_IO, with the name in error->file.
cau_status cli_mcap_create(cli_mcap *mcap, const char *name, cau_error *error);
// One message at a time, ns since 1970, at which it was seen. Errors: CAU_IO, CAU_NO_MEMORY.
cau_status cli_mcap_message(cli_mcap *mcap, uint64_t time_ns, const void *json, size_t byte_count,
                            cau_error *error);
// Writes the summary. Errors: CAU_IO (what was written did not all reach the file). May be called
// twice.
cau_status cli_mcap_close(cli_mcap *mcap, cau_error *error);
