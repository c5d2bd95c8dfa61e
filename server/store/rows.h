// SPDX-License-Identifier: GPL-3.0-or-later
// A session on its way from one store to another: table rows in pieces, as bytes. The functions are
// pure and work on the caller's memory. A piece may come from an untrusted sender, so every length
// and type is checked here.
//
// A piece is a head of 16 bytes (magic "CAUM", u32 version, u32 index, u32 flags), followed by rows
// to its end. A row is u8 table, u8 column count, and its columns. A column is u8 type, followed by
// 8 bytes of an i64, or by a u32 length and that many bytes of text or blob, or by nothing. All
// numbers are little-endian. On its way a piece has a seal of 64 hex digits after its end
// (server/move/courier.h).
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"
#include "store/store.h"

#define CAU_ROWS_VERSION 2
#define CAU_ROWS_HEAD_BYTES 16
#define CAU_ROWS_COLUMNS_MOST 8

// Columns: name, types of the table's columns. Types: u: an integer of 0 or more; i: any integer;
// k: any integer or null; s: a short text (at most 127 bytes); n: a short text or null; t: a text;
// b: bytes. Rows travel in the order of the tables here.
#define CAU_ROWS_TABLE(X)                                                                          \
	X(HEADER, "ssssss") /* move, lock, the source's id, its label, the session's name, unlock */   \
	X(SESSION, "sub")   /* state, created_ms, definition */                                        \
	X(MESH, "b")        /* mesh of the definition */                                               \
	X(PRESENT, "su")    /* state, branch: as they are when the session is suspended */             \
	X(BRANCHES, "uiuuuuu")  /* branch, parent, fork_tick, opened_ms, left_ms, bytes, end_tick */   \
	X(COMMANDS, "uuuinkb")  /* branch, tick, position, kind, client, sequence, payload */          \
	X(CHECKPOINTS, "uuiub") /* branch, tick, hash, bytes, snapshot */                              \
	X(EVENTS, "uuiust")     /* branch, tick, level, time_ms, kind, text */                         \
	X(CLIENTS, "su")        /* client, sequence */                                                 \
	X(MARKS, "uu")          /* branch, tick */                                                     \
	X(GAPS, "uuuu")         /* branch, from_tick, before_tick, trimmed */                          \
	X(ANSWERS, "suub")      /* client, sequence, time_ms, result */                                \
	X(FORGOTTEN, "suu")     /* client, sequence, time_ms */                                        \
	X(DRIVERS, "ssssuu")    /* tool, resume, client_id, name, role, deadline_us */                 \
	X(PACE, "u")            /* speed, in millionths */

typedef enum cau_rows_table {
#define X(name, columns) CAU_ROWS_##name,
	CAU_ROWS_TABLE(X)
#undef X
		CAU_ROWS_COUNT
} cau_rows_table;

typedef enum cau_rows_flags {
	// the last piece of the first reading: all rows from before the move are sent
	CAU_ROWS_PART_ENDS = 1,
	CAU_ROWS_ENDS = 2, // the last piece of the move: all rows since the first reading are sent too
} cau_rows_flags;

typedef struct cau_column {
	enum { CAU_COLUMN_NULL, CAU_COLUMN_INTEGER, CAU_COLUMN_TEXT, CAU_COLUMN_BLOB } type;
	int64_t integer;
	const char *bytes; // borrowed bytes of a text or blob, without a zero at the end
	size_t byte_count;
} cau_column;

typedef struct cau_row {
	cau_rows_table table;
	int column_count;
	cau_column column[CAU_ROWS_COLUMNS_MOST];
} cau_row;

// ---- reading: if cau_rows_check accepted a piece, all its rows can be read
typedef struct cau_rows_reader {
	const unsigned char *at, *end;
	uint32_t index, flags;
} cau_rows_reader;

// Opens a piece. Errors: CAU_CORRUPT; CAU_UNSUPPORTED: another version.
cau_status cau_rows_open(cau_rows_reader *reader, const void *bytes, size_t byte_count,
                         cau_error *error);
// Reads the next row. Its columns have the types of its table. CAU_NOT_FOUND: no more rows;
// CAU_CORRUPT.
cau_status cau_rows_next(cau_rows_reader *reader, cau_row *row, cau_error *error);
// Reads a whole piece. Returns CAU_OK if every row is complete and has its table's columns.
cau_status cau_rows_check(const void *bytes, size_t byte_count, cau_error *error);
// Copies a text column with a zero at the end, cut at the capacity.
void cau_rows_text(const cau_row *row, int column, char *text, size_t capacity);

// ---- writing
typedef struct cau_rows_writer {
	unsigned char *bytes; // malloc'ed; belongs to the caller when the piece is complete
	size_t byte_count, capacity;
	bool failed; // memory ran out: all rows since then are missing
} cau_rows_writer;

// Returns the bytes that the row takes in a piece.
size_t cau_rows_bytes(const cau_row *row);
void cau_rows_begin(cau_rows_writer *writer, uint32_t index);
void cau_rows_put(cau_rows_writer *writer, const cau_row *row);
// Writes a row from const char * and int64_t arguments, in the order of its table's columns.
void cau_rows_put_values(cau_rows_writer *writer, cau_rows_table table, ...);
void cau_rows_flag(cau_rows_writer *writer, uint32_t flags);
// Appends bytes after the last row. A reader removes them before it opens the piece.
void cau_rows_append(cau_rows_writer *writer, const void *bytes, size_t byte_count);

// ---- reading a session's records ----------------------------------------------------------------
// Reads all records of a session for another store, in two readings. The first reads what exists
// while the session runs. The second reads the new records, when the session is suspended and
// everything is on the disk. The dump has a connection of its own, so that other reads do not wait.
// Each of the two readings is one read transaction.

typedef struct cau_store_dump cau_store_dump;

// Opens a dump of `session`. Errors: CAU_NOT_FOUND, CAU_IO, CAU_NO_MEMORY. Only one thread at a
// time may use a dump.
cau_status cau_store_dump_open(cau_store *store, const char *session, cau_store_dump **dump,
                               cau_error *error);
// Adds records to the writer until it holds `bytes` or more. *over: this reading is complete.
cau_status cau_store_dump_write(cau_store_dump *dump, cau_rows_writer *writer, size_t bytes,
                                bool *over, cau_error *error);
// Begins the second reading, of the new records. Call it after the end of the first reading.
cau_status cau_store_dump_rest(cau_store_dump *dump, cau_error *error);
void cau_store_dump_close(cau_store_dump *dump); // closes the dump; `dump` may be NULL
