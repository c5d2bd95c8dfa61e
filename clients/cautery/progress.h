// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the progress of a long operation, and counts the faces that tools have removed. A terminal
// has one line that is redrawn; other outputs get a line for every tenth.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "cautery/stream.h"

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

// ---- faces -------------------------------------------------------------------------------------
// Counts faces that appear and disappear, relative to the first state that was seen in an epoch.
// When fat is removed, inner faces appear: they are bared.
typedef struct cli_faces {
	uint32_t *first; // face mask of the first state, or NULL before the first state
	uint64_t epoch;
	int64_t drawn; // faces drawn now
	int64_t gone;  // faces drawn at first and not now
	int64_t bared; // faces drawn now and not at first
} cli_faces;

// Counts the faces of `state`. Errors: CAU_NO_MEMORY, with all counts zero.
cau_status cli_faces_count(cli_faces *faces, const cau_stream_state *state, int32_t face_count);
void cli_faces_finish(cli_faces *faces);
