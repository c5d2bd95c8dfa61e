// SPDX-License-Identifier: GPL-3.0-or-later
// What the test's programs have in common: they are told by lines on standard input and tell, one
// JSON object a line, on standard output.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <time.h>

enum { LINE_BYTES = 512 };

typedef struct console {
	char kept[LINE_BYTES];
	size_t kept_bytes;
} console;

// Waits for standard input for at most `seconds`, then hands each whole line to `obey`. False at
// the input's end.
bool console_listen(console *c, double seconds, void (*obey)(void *user, const char *line),
                    void *user);

double clock_s(clockid_t clock);
