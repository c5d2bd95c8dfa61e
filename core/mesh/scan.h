// SPDX-License-Identifier: GPL-3.0-or-later
// Reads words and numbers from the bytes of a mesh file. After the first failure all results are
// empty or zero, so a reader needs to check `status` only once per loop.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_scan {
	const unsigned char *bytes; // borrowed
	size_t count;
	size_t at;
	size_t mark; // start of the item read last; failures report this position
	bool binary; // cau_scan_integer and cau_scan_real read binary numbers
	bool swap;   // binary numbers have the other byte order than this machine
	cau_status status;
	cau_error *error;
} cau_scan;

typedef struct cau_word {
	const char *text; // not terminated
	size_t length;    // 0: there is no word
} cau_word;

cau_scan cau_scan_make(const void *bytes, size_t byte_count, cau_error *error);

// Sets the failure, with "line 12: ..." or, among binary numbers, "byte 345: ...". After the first
// failure, further calls change nothing.
__attribute__((format(printf, 3, 4))) void cau_scan_fail(cau_scan *scan, cau_status status,
                                                         const char *format, ...);

static inline size_t cau_scan_left(const cau_scan *scan)
{
	return scan->count - scan->at;
}

// Reads the next word on this line. A backslash before the end of a line joins the next line.
cau_word cau_scan_word_of_line(cau_scan *scan);
// Reads the next word on this line or a later line.
cau_word cau_scan_word(cau_scan *scan);
// Returns the next word without moving past it.
cau_word cau_scan_peek(cau_scan *scan);
// Moves to the start of the next line.
void cau_scan_skip_line(cau_scan *scan);

// Whether two words are equal, except for the case of ASCII letters.
bool cau_word_is(cau_word word, const char *text);
// Reads a word, which must be `text`.
void cau_scan_expect(cau_scan *scan, const char *text);

// Reads a number in [least, most] that is written as text. `what` names the number in a failure.
int64_t cau_scan_text_integer(cau_scan *scan, const char *what, int64_t least, int64_t most);
int64_t cau_scan_word_integer(cau_scan *scan, cau_word word, const char *what, int64_t least,
                              int64_t most);
double cau_scan_word_real(cau_scan *scan, cau_word word, const char *what);

// Reads a number as text or, if `binary`, as a binary number of this width: a signed integer of 1,
// 2, 4 or 8 bytes, or a floating-point number of 4 or 8 bytes. Reals may be infinite or NaN.
int64_t cau_scan_integer(cau_scan *scan, const char *what, int bytes, int64_t least, int64_t most);
double cau_scan_real(cau_scan *scan, const char *what, int bytes);

// Reads a count that is written as text. Fails unless that many items of at least `item_bytes` each
// can follow.
int64_t cau_scan_count(cau_scan *scan, const char *what, int64_t item_bytes);
// Fails unless `count` items of at least `item_bytes` each can follow. `count` is not negative.
void cau_scan_check_count(cau_scan *scan, const char *what, int64_t count, int64_t item_bytes);

// Skips `byte_count` bytes.
void cau_scan_skip(cau_scan *scan, int64_t byte_count);
