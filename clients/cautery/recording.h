// SPDX-License-Identifier: GPL-3.0-or-later
// A stream in a file: what the server described and every frame as it came, so that what was seen
// can be decoded again. Little-endian:
//
//     8 bytes  "CAUREC01"
//     records  u32 kind, u32 byte_count, u64 received_us, bytes
//
// kind 1: a stream description, the whole JSON-RPC answer to session.join; kind 2: a frame. After a
// description come topology, key frame and deltas; another description starts anew.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "cautery/messages.h"

typedef enum cli_record_kind { CLI_RECORD_DESCRIPTION = 1, CLI_RECORD_FRAME = 2 } cli_record_kind;

typedef struct cli_recording {
	FILE *file;
	uint64_t frames, bytes;
	// reading
	unsigned char *buffer; // of the last record
	uint32_t capacity;
	uint64_t received_us;
} cli_recording;

// Errors: CAU_IO.
cau_status cli_recording_create(cli_recording *recording, const char *name, cau_error *error);
cau_status cli_recording_describe(cli_recording *recording,
                                  const cau_wire_stream_description *description, cau_error *error);
cau_status cli_recording_frame(cli_recording *recording, double received_s, const void *bytes,
                               size_t byte_count, cau_error *error);

// Errors: CAU_IO, CAU_CORRUPT (no recording).
cau_status cli_recording_open(cli_recording *recording, const char *name, cau_error *error);
// The same from an open file, which cli_recording_close closes, also after an error.
cau_status cli_recording_read(cli_recording *recording, FILE *file, cau_error *error);
// The next record; *kind 0 at the end. Its bytes are recording->buffer. Errors: CAU_CORRUPT (cut
// short, or of no known kind), CAU_NO_MEMORY.
cau_status cli_recording_next(cli_recording *recording, uint32_t *kind, uint32_t *byte_count,
                              cau_error *error);
cau_status cli_recording_read_description(const cli_recording *recording, uint32_t byte_count,
                                          cau_wire_stream_description *description,
                                          cau_error *error);

// Errors: CAU_IO (what was written did not all reach the file). May be called twice.
cau_status cli_recording_close(cli_recording *recording, cau_error *error);
