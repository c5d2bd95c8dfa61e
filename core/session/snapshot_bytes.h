// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a snapshot. Every number has a fixed width, little-endian order and an allowed
// range. The same walk over the state (snapshot_state.c) counts bytes, writes them, or reads them
// and refuses a number outside its range.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum snapshot_mode { SNAPSHOT_COUNT, SNAPSHOT_WRITE, SNAPSHOT_READ } snapshot_mode;

typedef struct snapshot_archive {
	snapshot_mode mode;
	unsigned char *bytes; // not changed by READ; NULL for COUNT
	size_t at, capacity;
	const char *wrong; // READ: name of the first refused number, where reading ends, or NULL
} snapshot_archive;

// Limit for any finite number in the state. Its square is far from overflow in double.
#define SNAPSHOT_ANY 1e30

// Each function passes `count` numbers at `value`; `what` is their name in a refusal. Numbers from
// least to most are allowed, both included; NaN is not.
void cau_snapshot_doubles(snapshot_archive *archive, const char *what, double *value, size_t count,
                          double least, double most);
void cau_snapshot_floats(snapshot_archive *archive, const char *what, float *value, size_t count,
                         double least, double most);
void cau_snapshot_ints(snapshot_archive *archive, const char *what, int32_t *value, size_t count,
                       int64_t least, int64_t most);
void cau_snapshot_longs(snapshot_archive *archive, const char *what, int64_t *value, size_t count,
                        int64_t least, int64_t most);
void cau_snapshot_words(snapshot_archive *archive, const char *what, uint64_t *value, size_t count,
                        uint64_t most);
void cau_snapshot_shorts(snapshot_archive *archive, const char *what, uint16_t *value, size_t count,
                         uint16_t most);
void cau_snapshot_octets(snapshot_archive *archive, const char *what, uint8_t *value, size_t count,
                         uint8_t most);
void cau_snapshot_bool(snapshot_archive *archive, const char *what, bool *value);

// Passes a number for each of `count` elements, in the session's precision. The number of element e
// is in slot slot_of[e] of `array` (floats if `single`, else doubles).
void cau_snapshot_slots(snapshot_archive *archive, const char *what, void *array, bool single,
                        const int32_t *slot_of, size_t count, double least, double most);
// Passes `count` consecutive numbers in the session's precision.
void cau_snapshot_reals(snapshot_archive *archive, const char *what, void *array, bool single,
                        size_t count);

// Passes `size` bytes of text with at least one zero. The bytes after the first zero are written as
// zeros.
void cau_snapshot_text(snapshot_archive *archive, const char *what, char *text, size_t size);

// Ends reading with a refusal that names `what`.
void cau_snapshot_refuse(snapshot_archive *archive, const char *what);
