// SPDX-License-Identifier: GPL-3.0-or-later
// How far a long thing is: one line kept fresh on a terminal, a line for every tenth elsewhere.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Puts `line` in the place of the terminal's last one, cut to its width, so that it never wraps.
void cli_refresh_line(FILE *out, const char *line);

typedef struct cli_progress {
	FILE *out;
	bool terminal;
	const char *what;
	int tenth;      // last line's, -1: none yet
	double drawn_s; // when a terminal's line was last drawn
} cli_progress;

void cli_progress_begin(cli_progress *progress, FILE *out, const char *what);
// Shown as "what 40 % note"; the note may be NULL.
void cli_progress_show(cli_progress *progress, uint64_t done, uint64_t total, const char *note);
void cli_progress_end(cli_progress *progress);

// A cau_client_progress whose user is a cli_progress.
void cli_progress_bytes(void *user, uint64_t done, uint64_t total);
