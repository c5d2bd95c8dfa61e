// SPDX-License-Identifier: GPL-3.0-or-later
// Files to which streams are recorded. One holds the stream itself, the other (MCAP) holds scenes.
//
// A recorded stream: the server's description and every frame as received, so that it can be
// decoded later. All numbers are little-endian:
//
//   8 bytes  "CAUREC01"
//   records  u32 kind, u32 byte_count, u64 received_us, bytes
//
// Kind 1 is a stream description: the whole JSON-RPC answer to session.join. Kind 2 is a frame.
// After a description come a topology frame, a key frame and deltas. Another description starts a
// new sequence.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "cautery/client.h"
#include "cautery/messages.h"

typedef enum cli_record_kind { CLI_RECORD_DESCRIPTION = 1, CLI_RECORD_FRAME = 2 } cli_record_kind;

typedef struct cli_recording {
	FILE *file;
	uint64_t frames, bytes;
	// only for reading
	unsigned char *buffer; // bytes of the last record
	uint32_t capacity;
	uint64_t received_us;
} cli_recording;

// Creates the file. Errors: CAU_IO.
cau_status cli_recording_create(cli_recording *recording, const char *name, cau_error *error);
cau_status cli_recording_describe(cli_recording *recording,
                                  const cau_wire_stream_description *description, cau_error *error);
cau_status cli_recording_frame(cli_recording *recording, double received_s, const void *bytes,
                               size_t byte_count, cau_error *error);

// Opens a recording. Errors: CAU_IO, CAU_CORRUPT (not a recording).
cau_status cli_recording_open(cli_recording *recording, const char *name, cau_error *error);
// Reads a recording from an open file. cli_recording_close closes the file, also after an error.
cau_status cli_recording_read(cli_recording *recording, FILE *file, cau_error *error);
// Reads the next record into recording->buffer. *kind is 0 at the end. Errors: CAU_CORRUPT (cut
// short, or of an unknown kind), CAU_NO_MEMORY.
cau_status cli_recording_next(cli_recording *recording, uint32_t *kind, uint32_t *byte_count,
                              cau_error *error);
cau_status cli_recording_read_description(const cli_recording *recording, uint32_t byte_count,
                                          cau_wire_stream_description *description,
                                          cau_error *error);

// Closes the file. A second call does nothing. Errors: CAU_IO if some bytes did not reach the file.
cau_status cli_recording_close(cli_recording *recording, cau_error *error);

// ---- MCAP (mcap.c) -----------------------------------------------------------------------------
// Writes an MCAP file (mcap.dev/spec) with one channel: foxglove.SceneUpdate as JSON, on the topic
// "/scene". Each message is a chunk of its own, without compression, so that a reader can seek to
// any time. The summary at the end has the chunk index and the statistics. A file that was never
// closed lacks the summary and can still be read from the beginning.
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

// ---- scenes (scene_update.c) -------------------------------------------------------------------
// Writes a stream's newest state as foxglove.SceneUpdate in JSON. The tissue's present faces are
// triangles, in one list for each layer. Each tool is a shaft with a tip, which glows while energy
// is on. The viewer's model/scene_update.ts writes the same.

// The stream must be synced and have its topology, positions, mask and tools. `time_ns` is the time
// of the message and of everything in it, ns since 1970. The metadata have the tick and the
// simulated time. Errors: CAU_NO_MEMORY.
cau_status cli_scene_update_write(FILE *out, const cau_client_stream *stream, uint64_t time_ns,
                                  cau_error *error);
