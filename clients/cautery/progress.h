// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the progress of a long operation. A terminal has one line that is redrawn; other outputs
// get a line for every tenth.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Replaces the terminal's last line by `line`. The line is cut to the terminal's width, so it never
// wraps.
void cli_refresh_line(FILE *out, const char *line);

typedef struct cli_progress {
	FILE *out;
	bool terminal;
	const char *what;
	int tenth;      // tenth of the last line, -1 before the first line
	double drawn_s; // time at which a terminal's line was last drawn
} cli_progress;

void cli_progress_begin(cli_progress *progress, FILE *out, const char *what);
// Shows "what 40 % note". The note may be NULL.
void cli_progress_show(cli_progress *progress, uint64_t done, uint64_t total, const char *note);
void cli_progress_end(cli_progress *progress);

// A cau_client_progress callback. `user` is a cli_progress.
void cli_progress_bytes(void *user, uint64_t done, uint64_t total);
