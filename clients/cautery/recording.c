// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/recording.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/rpc.h"

enum {
	MAGIC_BYTES = 8,
	HEAD_BYTES = 16,
	RECORD_BYTES_MAX = 1 << 30,
	DESCRIPTION_BYTES_MAX = 4096,
	FIRST_ROOM_BYTES = 1 << 16,
};

static const char magic[MAGIC_BYTES + 1] = "CAUREC01";

static void put(unsigned char *at, uint64_t value, int bytes)
{
	for (int i = 0; i < bytes; i++)
		at[i] = (unsigned char)(value >> 8 * i);
}

static uint64_t get(const unsigned char *at, int bytes)
{
	uint64_t value = 0;
	for (int i = 0; i < bytes; i++)
		value |= (uint64_t)at[i] << 8 * i;
	return value;
}

static cau_status open_file(cli_recording *recording, const char *name, const char *mode,
                            cau_error *error)
{
	*recording = (cli_recording){.file = fopen(name, mode)};
	snprintf(error->file, sizeof error->file, "%.255s", name);
	return recording->file ? CAU_OK : cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
}

// ---- writing -----------------------------------------------------------------------------------
cau_status cli_recording_create(cli_recording *recording, const char *name, cau_error *error)
{
	cau_status status = open_file(recording, name, "wb", error);
	if (!status && fwrite(magic, 1, MAGIC_BYTES, recording->file) != MAGIC_BYTES)
		status = cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
	return status;
}

static cau_status write_record(cli_recording *recording, cli_record_kind kind, double received_s,
                               const void *bytes, size_t byte_count, cau_error *error)
{
	unsigned char head[HEAD_BYTES];
	put(head, (uint64_t)kind, 4);
	put(head + 4, byte_count, 4);
	put(head + 8, (uint64_t)(received_s * 1e6), 8);
	if (fwrite(head, 1, HEAD_BYTES, recording->file) != HEAD_BYTES ||
	    fwrite(bytes, 1, byte_count, recording->file) != byte_count)
		return cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
	recording->bytes += HEAD_BYTES + byte_count;
	return CAU_OK;
}

cau_status cli_recording_describe(cli_recording *recording,
                                  const cau_wire_stream_description *description, cau_error *error)
{
	char text[DESCRIPTION_BYTES_MAX];
	cau_rpc_buffer out = {text, sizeof text, 0};
	cau_rpc_id id = {.kind = CAU_RPC_ID_NUMBER};
	cau_status status =
		cau_rpc_write_result(&out, &id, CAU_METHOD_SESSION_JOIN, description, error);
	if (status)
		return status;
	return write_record(recording, CLI_RECORD_DESCRIPTION, 0, text, out.bytes, error);
}

cau_status cli_recording_frame(cli_recording *recording, double received_s, const void *bytes,
                               size_t byte_count, cau_error *error)
{
	recording->frames++;
	return write_record(recording, CLI_RECORD_FRAME, received_s, bytes, byte_count, error);
}

// ---- reading -----------------------------------------------------------------------------------
cau_status cli_recording_read(cli_recording *recording, FILE *file, cau_error *error)
{
	char found[MAGIC_BYTES];
	*recording = (cli_recording){.file = file};
	if (fread(found, 1, MAGIC_BYTES, file) != MAGIC_BYTES || memcmp(found, magic, MAGIC_BYTES) != 0)
		return cau_fail(error, CAU_CORRUPT, NULL, "is not a recording of `cautery record`");
	return CAU_OK;
}

cau_status cli_recording_open(cli_recording *recording, const char *name, cau_error *error)
{
	cau_status status = open_file(recording, name, "rb", error);
	return status ? status : cli_recording_read(recording, recording->file, error);
}

// Reads the record's bytes. The memory grows with the data read, so a false length takes at most
// twice the size of the file.
static cau_status read_bytes(cli_recording *recording, uint32_t byte_count, cau_error *error)
{
	for (uint32_t done = 0; done < byte_count;) {
		uint32_t room = done < FIRST_ROOM_BYTES ? FIRST_ROOM_BYTES : 2 * done;
		room = room < byte_count ? room : byte_count;
		if (room > recording->capacity) {
			void *grown = realloc(recording->buffer, room);
			if (!grown)
				return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a record");
			recording->buffer = grown;
			recording->capacity = room;
		}
		uint32_t wanted = room - done;
		if (fread(recording->buffer + done, 1, wanted, recording->file) != wanted)
			return cau_fail(error, CAU_CORRUPT, NULL, "is truncated");
		done = room;
	}
	return CAU_OK;
}

cau_status cli_recording_next(cli_recording *recording, uint32_t *kind, uint32_t *byte_count,
                              cau_error *error)
{
	unsigned char head[HEAD_BYTES];
	size_t bytes = fread(head, 1, HEAD_BYTES, recording->file);
	*kind = 0;
	if (bytes == 0 && feof(recording->file))
		return CAU_OK;
	if (bytes < HEAD_BYTES)
		return cau_fail(error, CAU_CORRUPT, NULL, "is truncated");
	uint32_t found = (uint32_t)get(head, 4);
	*byte_count = (uint32_t)get(head + 4, 4);
	recording->received_us = get(head + 8, 8);
	if ((found != CLI_RECORD_DESCRIPTION && found != CLI_RECORD_FRAME) ||
	    *byte_count > RECORD_BYTES_MAX)
		return cau_fail(error, CAU_CORRUPT, NULL, "holds a record of an unknown kind");
	cau_status status = read_bytes(recording, *byte_count, error);
	if (status)
		return status;
	*kind = found;
	return CAU_OK;
}

cau_status cli_recording_read_description(const cli_recording *recording, uint32_t byte_count,
                                          cau_wire_stream_description *description,
                                          cau_error *error)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	if (cau_rpc_read((const char *)recording->buffer, byte_count, DESCRIPTION_BYTES_MAX, &message,
	                 &fault))
		return cau_fail(error, CAU_CORRUPT, NULL, "holds no stream description: %s", fault.reason);
	cau_status status = message.kind == CAU_RPC_RESULT
	                        ? cau_rpc_result(&message, CAU_METHOD_SESSION_JOIN, description, error)
	                        : cau_fail(error, CAU_CORRUPT, NULL, "holds no stream description");
	cau_rpc_finish(&message);
	return status;
}

cau_status cli_recording_close(cli_recording *recording, cau_error *error)
{
	FILE *file = recording->file;
	free(recording->buffer);
	recording->buffer = NULL;
	recording->capacity = 0;
	recording->file = NULL;
	return file && fclose(file) ? cau_fail(error, CAU_IO, NULL, "%s", strerror(errno)) : CAU_OK;
}
