// SPDX-License-Identifier: GPL-3.0-or-later
// Common functions of the test programs. A program reads commands as lines from standard input, and
// writes events as JSON objects, one a line, to standard output.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <time.h>

enum { LINE_BYTES = 512 };

typedef struct console {
	char kept[LINE_BYTES];
	size_t kept_bytes;
} console;

// Waits for standard input, `seconds` at most, then passes each whole line to `obey`. Returns false
// at the end of the input.
bool console_listen(console *c, double seconds, void (*obey)(void *user, const char *line),
                    void *user);

double clock_s(clockid_t clock);
