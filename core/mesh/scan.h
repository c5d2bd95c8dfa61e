// SPDX-License-Identifier: GPL-3.0-or-later
// Reading words and numbers from the bytes of a mesh file. The first failure sticks: everything
// read after it is empty or zero, so that a reader looks at `status` once per loop.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_scan {
	const unsigned char *bytes; // borrowed
	size_t count;
	size_t at;
	size_t mark; // start of the last item read: failures are reported from here
	bool binary; // cau_scan_integer and cau_scan_real read binary numbers
	bool swap;   // whose byte order is not this machine's
	cau_status status;
	cau_error *error;
} cau_scan;

typedef struct cau_word {
	const char *text; // not terminated
	size_t length;    // 0: there was none
} cau_word;

cau_scan cau_scan_make(const void *bytes, size_t byte_count, cau_error *error);

// Fails with "line 12: ..." or, among binary numbers, "byte 345: ...". Later failures change
// nothing.
__attribute__((format(printf, 3, 4))) void cau_scan_fail(cau_scan *scan, cau_status status,
                                                         const char *format, ...);

static inline size_t cau_scan_left(const cau_scan *scan)
{
	return scan->count - scan->at;
}

// Next word on this line (a backslash before the line's end joins the next one), or on any line.
cau_word cau_scan_word_of_line(cau_scan *scan);
cau_word cau_scan_word(cau_scan *scan);
// The next word, which stays to be read.
cau_word cau_scan_peek(cau_scan *scan);
// Goes to the start of the next line.
void cau_scan_skip_line(cau_scan *scan);

// Equal but for the case of ASCII letters.
bool cau_word_is(cau_word word, const char *text);
// Reads a word, which must be `text`.
void cau_scan_expect(cau_scan *scan, const char *text);

// A number written as text in [least, most]; `what` names it in the failure.
int64_t cau_scan_text_integer(cau_scan *scan, const char *what, int64_t least, int64_t most);
int64_t cau_scan_word_integer(cau_scan *scan, cau_word word, const char *what, int64_t least,
                              int64_t most);
double cau_scan_word_real(cau_scan *scan, cau_word word, const char *what);

// A number as text, or in binary of this width: a signed integer of 1, 2, 4 or 8 bytes, a floating
// one of 4 or 8 bytes. Reals may be infinite or NaN.
int64_t cau_scan_integer(cau_scan *scan, const char *what, int bytes, int64_t least, int64_t most);
double cau_scan_real(cau_scan *scan, const char *what, int bytes);

// A count written as text, of things that take at least `item_bytes` each of what is left.
int64_t cau_scan_count(cau_scan *scan, const char *what, int64_t item_bytes);
// Fails unless `count` (not negative) such things can be left.
void cau_scan_check_count(cau_scan *scan, const char *what, int64_t count, int64_t item_bytes);

// Passes over `byte_count` bytes.
void cau_scan_skip(cau_scan *scan, int64_t byte_count);
