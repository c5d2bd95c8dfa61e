// SPDX-License-Identifier: GPL-3.0-or-later
// A session on its way from one store to another: pieces of rows, as bytes. Pure functions over the
// caller's memory; what is read may come from anybody, so every length and type is checked here.
//
// A piece is a head of 16 bytes (magic "CAUM", u32 version, u32 index, u32 flags) and then rows to
// its end. A row is u8 table, u8 column count, and its columns: u8 type, then an i64 of 8 bytes, or
// u32 length and so many bytes of text or blob, or nothing. All numbers are little-endian. On its
// way a piece has a seal of 64 hex digits after its end (server/move/courier.h).
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

#define CAU_ROWS_VERSION 2
#define CAU_ROWS_HEAD_BYTES 16
#define CAU_ROWS_COLUMNS_MOST 8

// name, columns. Of a column: u an integer of 0 or more, i any integer, k the same or null, s a
// short text (at most 127 bytes), n the same or null, t a text, b bytes. The order is that in which
// rows travel.
#define CAU_ROWS_TABLE(X)                                                                          \
	X(HEADER, "ssssss") /* move, lock, the source's id, its label, the session's name, unlock */   \
	X(SESSION, "sub")   /* state, created_ms, definition */                                        \
	X(MESH, "b")        /* of the definition */                                                    \
	X(PRESENT, "su")    /* state, branch: as they are when the session stands still */             \
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
	CAU_ROWS_PART_ENDS = 1, // what was there when the move began has all come
	CAU_ROWS_ENDS = 2,      // and what has come about since
} cau_rows_flags;

typedef struct cau_column {
	enum { CAU_COLUMN_NULL, CAU_COLUMN_INTEGER, CAU_COLUMN_TEXT, CAU_COLUMN_BLOB } type;
	int64_t integer;
	const char *bytes; // of text and blob, borrowed; no zero follows
	size_t byte_count;
} cau_column;

typedef struct cau_row {
	cau_rows_table table;
	int column_count;
	cau_column column[CAU_ROWS_COLUMNS_MOST];
} cau_row;

// ---- reading: a piece that cau_rows_check has passed gives all its rows
typedef struct cau_rows_reader {
	const unsigned char *at, *end;
	uint32_t index, flags;
} cau_rows_reader;

// CAU_CORRUPT, CAU_UNSUPPORTED (another version).
cau_status cau_rows_open(cau_rows_reader *reader, const void *bytes, size_t byte_count,
                         cau_error *error);
// The next row, whose columns are as its table's are. CAU_NOT_FOUND: there is none; CAU_CORRUPT.
cau_status cau_rows_next(cau_rows_reader *reader, cau_row *row, cau_error *error);
// Reads all of a piece. CAU_OK: every row is whole and as its table wants it.
cau_status cau_rows_check(const void *bytes, size_t byte_count, cau_error *error);
// A text column with its zero, cut at the capacity.
void cau_rows_text(const cau_row *row, int column, char *text, size_t capacity);

// ---- writing
typedef struct cau_rows_writer {
	unsigned char *bytes; // malloc'ed; the caller's once it is done
	size_t byte_count, capacity;
	bool failed; // there was no memory: what was written since is missing
} cau_rows_writer;

// Bytes that the row takes.
size_t cau_rows_bytes(const cau_row *row);
void cau_rows_begin(cau_rows_writer *writer, uint32_t index);
void cau_rows_put(cau_rows_writer *writer, const cau_row *row);
// A row of texts and integers, by its table's columns: const char *, int64_t.
void cau_rows_put_values(cau_rows_writer *writer, cau_rows_table table, ...);
void cau_rows_flag(cau_rows_writer *writer, uint32_t flags);
// Appends bytes after the last row. A reader removes them before it opens the piece.
void cau_rows_append(cau_rows_writer *writer, const void *bytes, size_t byte_count);
