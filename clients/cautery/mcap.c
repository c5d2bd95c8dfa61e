// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/recording.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum {
	SCHEMA_ID = 1,
	CHANNEL_ID = 0,
	RECORD_HEAD_BYTES = 1 + 8,            // opcode, length
	MESSAGE_HEAD_BYTES = 2 + 4 + 8 + 8,   // channel, sequence, log time, publish time
	CHUNK_HEAD_BYTES = 8 * 3 + 4 * 2 + 8, // times, sizes, CRC, the compression's empty name
	INDEX_BYTES = 2 + 4 + 8 + 8,          // channel, bytes of the array, time, offset in the chunk
	// capacity that is larger than every record except schemas, messages and chunks
	SMALL_RECORD_BYTES = 256,
	FIRST_CHUNKS = 64,
};

// Opcodes of the MCAP specification.
enum {
	HEADER = 0x01,
	FOOTER = 0x02,
	SCHEMA = 0x03,
	CHANNEL = 0x04,
	MESSAGE = 0x05,
	CHUNK = 0x06,
	MESSAGE_INDEX = 0x07,
	CHUNK_INDEX = 0x08,
	STATISTICS = 0x0b,
	DATA_END = 0x0f,
};

static const unsigned char magic[] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

struct cli_mcap_chunk {
	uint64_t time_ns;
	uint64_t offset; // offset of the chunk record in the file
	uint64_t bytes;  // size of the chunk record, with its head
};

// ---- records -----------------------------------------------------------------------------------
typedef struct record {
	unsigned char bytes[SMALL_RECORD_BYTES];
	size_t count;
} record;

static void put(record *r, uint64_t value, int bytes)
{
	for (int i = 0; i < bytes; i++)
		r->bytes[r->count++] = (unsigned char)(value >> 8 * i);
}

static void put_text(record *r, const char *text)
{
	size_t count = strlen(text);
	put(r, count, 4);
	memcpy(r->bytes + r->count, text, count);
	r->count += count;
}

// Writes bytes. The FILE stream keeps its own error until cli_mcap_close. `mcap->bytes` also counts
// bytes that could not be written.
static void emit(cli_mcap *mcap, const void *bytes, size_t count)
{
	fwrite(bytes, 1, count, mcap->file);
	mcap->bytes += count;
}

// Writes a record. `more` is the number of its bytes that the caller writes afterwards.
static void emit_record(cli_mcap *mcap, int opcode, const record *r, size_t more)
{
	record head = {.count = 0};
	put(&head, (uint64_t)opcode, 1);
	put(&head, r->count + more, 8);
	emit(mcap, head.bytes, head.count);
	emit(mcap, r->bytes, r->count);
}

static cau_status written(const cli_mcap *mcap, cau_error *error)
{
	return ferror(mcap->file) ? cau_fail(error, CAU_IO, NULL, "%s", strerror(errno)) : CAU_OK;
}

// ---- records at the beginning, repeated in the summary ----------------------------------------
static void emit_schema(cli_mcap *mcap)
{
	record r = {.count = 0};
	size_t count = 0;
	for (const char *const *piece = cli_mcap_schema; *piece; piece++)
		count += strlen(*piece);
	put(&r, SCHEMA_ID, 2);
	put_text(&r, "foxglove.SceneUpdate");
	put_text(&r, "jsonschema");
	put(&r, count, 4);
	emit_record(mcap, SCHEMA, &r, count);
	for (const char *const *piece = cli_mcap_schema; *piece; piece++)
		emit(mcap, *piece, strlen(*piece));
}

static void emit_channel(cli_mcap *mcap)
{
	record r = {.count = 0};
	put(&r, CHANNEL_ID, 2);
	put(&r, SCHEMA_ID, 2);
	put_text(&r, "/scene");
	put_text(&r, "json");
	put(&r, 0, 4); // size of the channel's metadata, which is empty
	emit_record(mcap, CHANNEL, &r, 0);
}

cau_status cli_mcap_create(cli_mcap *mcap, const char *name, cau_error *error)
{
	record header = {.count = 0};
	*mcap = (cli_mcap){.file = fopen(name, "wb")};
	snprintf(error->file, sizeof error->file, "%.255s", name);
	if (!mcap->file)
		return cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
	emit(mcap, magic, sizeof magic);
	put_text(&header, ""); // the file's profile, which is empty
	put_text(&header, "cautery");
	emit_record(mcap, HEADER, &header, 0);
	emit_schema(mcap);
	emit_channel(mcap);
	return written(mcap, error);
}

// ---- messages ----------------------------------------------------------------------------------
static cau_status remember_chunk(cli_mcap *mcap, cli_mcap_chunk chunk, cau_error *error)
{
	if (mcap->messages == mcap->capacity) {
		uint32_t capacity = mcap->capacity ? 2 * mcap->capacity : FIRST_CHUNKS;
		cli_mcap_chunk *grown = realloc(mcap->chunks, capacity * sizeof *grown);
		if (!grown)
			return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the file's index");
		mcap->chunks = grown;
		mcap->capacity = capacity;
	}
	mcap->chunks[mcap->messages++] = chunk;
	return CAU_OK;
}

cau_status cli_mcap_message(cli_mcap *mcap, uint64_t time_ns, const void *json, size_t byte_count,
                            cau_error *error)
{
	record chunk = {.count = 0}, message = {.count = 0}, index = {.count = 0};
	uint64_t offset = mcap->bytes;
	size_t record_bytes = RECORD_HEAD_BYTES + MESSAGE_HEAD_BYTES + byte_count;
	put(&chunk, time_ns, 8); // time of the chunk's first message
	put(&chunk, time_ns, 8); // time of the chunk's last message
	put(&chunk, record_bytes, 8);
	put(&chunk, 0, 4); // CRC; 0: not computed
	put_text(&chunk, "");
	put(&chunk, record_bytes, 8);
	emit_record(mcap, CHUNK, &chunk, record_bytes);

	put(&message, CHANNEL_ID, 2);
	put(&message, mcap->messages, 4);
	put(&message, time_ns, 8); // log time
	put(&message, time_ns, 8); // publish time
	emit_record(mcap, MESSAGE, &message, byte_count);
	emit(mcap, json, byte_count);
	uint64_t chunk_bytes = mcap->bytes - offset;

	put(&index, CHANNEL_ID, 2);
	put(&index, 8 + 8, 4);
	put(&index, time_ns, 8);
	put(&index, 0, 8); // offset in the chunk: 0, because the chunk has one message
	emit_record(mcap, MESSAGE_INDEX, &index, 0);
	cau_status status = written(mcap, error);
	return status ? status
	              : remember_chunk(mcap, (cli_mcap_chunk){time_ns, offset, chunk_bytes}, error);
}

// ---- summary -----------------------------------------------------------------------------------
static void emit_chunk_index(cli_mcap *mcap, const cli_mcap_chunk *chunk)
{
	record r = {.count = 0};
	uint64_t content_bytes = chunk->bytes - RECORD_HEAD_BYTES - CHUNK_HEAD_BYTES;
	put(&r, chunk->time_ns, 8);
	put(&r, chunk->time_ns, 8);
	put(&r, chunk->offset, 8);
	put(&r, chunk->bytes, 8);
	put(&r, 2 + 8, 4); // length of the next map in bytes: one channel (2) and one offset (8)
	put(&r, CHANNEL_ID, 2);
	put(&r, chunk->offset + chunk->bytes, 8);
	put(&r, RECORD_HEAD_BYTES + INDEX_BYTES, 8);
	put_text(&r, ""); // name of the compression; empty: not compressed
	put(&r, content_bytes, 8);
	put(&r, content_bytes, 8);
	emit_record(mcap, CHUNK_INDEX, &r, 0);
}

static void emit_statistics(cli_mcap *mcap)
{
	record r = {.count = 0};
	uint64_t first_ns = UINT64_MAX, last_ns = 0;
	for (uint32_t i = 0; i < mcap->messages; i++) {
		uint64_t time_ns = mcap->chunks[i].time_ns;
		first_ns = time_ns < first_ns ? time_ns : first_ns;
		last_ns = time_ns > last_ns ? time_ns : last_ns;
	}
	put(&r, mcap->messages, 8);
	put(&r, 1, 2);              // number of schemas
	put(&r, 1, 4);              // number of channels
	put(&r, 0, 4);              // number of attachments
	put(&r, 0, 4);              // number of metadata records
	put(&r, mcap->messages, 4); // number of chunks
	put(&r, mcap->messages ? first_ns : 0, 8);
	put(&r, last_ns, 8);
	put(&r, 2 + 8, 4); // length of the next map in bytes: one channel (2) and its message count (8)
	put(&r, CHANNEL_ID, 2);
	put(&r, mcap->messages, 8);
	emit_record(mcap, STATISTICS, &r, 0);
}

static void emit_summary(cli_mcap *mcap)
{
	record end = {.count = 0}, footer = {.count = 0};
	put(&end, 0, 4); // CRC; 0: not computed
	emit_record(mcap, DATA_END, &end, 0);
	uint64_t start = mcap->bytes;
	emit_schema(mcap);
	emit_channel(mcap);
	emit_statistics(mcap);
	for (uint32_t i = 0; i < mcap->messages; i++)
		emit_chunk_index(mcap, &mcap->chunks[i]);
	put(&footer, start, 8);
	put(&footer, 0, 8); // position of the summary offsets; 0: the file has none
	put(&footer, 0, 4); // CRC; 0: not computed
	emit_record(mcap, FOOTER, &footer, 0);
	emit(mcap, magic, sizeof magic);
}

cau_status cli_mcap_close(cli_mcap *mcap, cau_error *error)
{
	cau_status status = CAU_OK;
	if (!mcap->file)
		return CAU_OK;
	emit_summary(mcap);
	status = written(mcap, error);
	if (fclose(mcap->file) && !status)
		status = cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
	mcap->file = NULL;
	free(mcap->chunks);
	mcap->chunks = NULL;
	mcap->capacity = 0;
	return status;
}
