// SPDX-License-Identifier: GPL-3.0-or-later
// Writes an MCAP file (mcap.dev/spec) with one channel: foxglove.SceneUpdate as JSON, on the topic
// "/scene". Each message is a chunk of its own, without compression, so that a reader can seek to
// any time. The summary at the end has the chunk index and the statistics. A file that was never
// closed lacks the summary and can still be read from the beginning.
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "cautery/status.h"

typedef struct cli_mcap_chunk cli_mcap_chunk;

typedef struct cli_mcap {
	FILE *file;
	uint64_t bytes; // bytes written so far
	uint32_t messages;
	cli_mcap_chunk *chunks; // (messages) chunks, for the summary
	uint32_t capacity;
} cli_mcap;

// The schema of messages: foxglove.SceneUpdate in JSON Schema, in pieces. NULL marks the end.
extern const char *const cli_mcap_schema[];

// Creates the file. Errors: CAU_IO, with the name in error->file.
cau_status cli_mcap_create(cli_mcap *mcap, const char *name, cau_error *error);
// Writes one message that was seen at `time_ns`, ns since 1970. Errors: CAU_IO, CAU_NO_MEMORY.
cau_status cli_mcap_message(cli_mcap *mcap, uint64_t time_ns, const void *json, size_t byte_count,
                            cau_error *error);
// Writes the summary and closes the file. A second call does nothing. Errors: CAU_IO if some bytes
// did not reach the file.
cau_status cli_mcap_close(cli_mcap *mcap, cau_error *error);
