// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/progress.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cautery/client.h"

static const double redraw_s = 0.1;

enum { COLUMNS_UNKNOWN = 80 };

void cli_refresh_line(FILE *out, const char *line)
{
	struct winsize size = {0};
	bool known = ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
	fprintf(out, "\r\033[K%.*s", (known ? size.ws_col : COLUMNS_UNKNOWN) - 1, line);
	fflush(out);
}

void cli_progress_begin(cli_progress *progress, FILE *out, const char *what)
{
	*progress =
		(cli_progress){.out = out, .terminal = isatty(fileno(out)), .what = what, .tenth = -1};
}

void cli_progress_show(cli_progress *progress, uint64_t done, uint64_t total, const char *note)
{
	char line[512];
	double share = total ? (double)done / (double)total : 1.0;
	int tenth = (int)(10.0 * share);
	double now_s = cau_client_now();
	if (progress->terminal && now_s - progress->drawn_s >= redraw_s) {
		snprintf(line, sizeof line, "%s %.0f %% %s", progress->what, 100.0 * share,
		         note ? note : "");
		cli_refresh_line(progress->out, line);
		progress->drawn_s = now_s;
	} else if (!progress->terminal && tenth > progress->tenth) {
		fprintf(progress->out, "%s %d %%%s%s\n", progress->what, 10 * tenth, note ? " " : "",
		        note ? note : "");
	}
	progress->tenth = tenth > progress->tenth ? tenth : progress->tenth;
	fflush(progress->out);
}

void cli_progress_end(cli_progress *progress)
{
	if (progress->terminal)
		fputs("\r\033[K", progress->out);
	fflush(progress->out);
}

void cli_progress_bytes(void *user, uint64_t done, uint64_t total)
{
	cli_progress_show(user, done, total, NULL);
}

// ---- faces -------------------------------------------------------------------------------------
void cli_faces_finish(cli_faces *faces)
{
	free(faces->first);
	*faces = (cli_faces){0};
}

static cau_status begin_epoch(cli_faces *faces, const cau_stream_state *state, size_t words)
{
	cli_faces_finish(faces);
	faces->first = malloc((words + 1) * sizeof *faces->first);
	if (!faces->first)
		return CAU_NO_MEMORY;
	memcpy(faces->first, state->face_mask, words * sizeof *faces->first);
	faces->epoch = state->epoch;
	return CAU_OK;
}

cau_status cli_faces_count(cli_faces *faces, const cau_stream_state *state, int32_t face_count)
{
	size_t words = ((size_t)face_count + 31) / 32;
	if (!state->synced || !state->face_mask)
		return CAU_OK;
	if ((!faces->first || faces->epoch != state->epoch) && begin_epoch(faces, state, words))
		return CAU_NO_MEMORY;
	faces->drawn = face_count;
	faces->gone = faces->bared = 0;
	for (size_t i = 0; i < words; i++) {
		faces->drawn -= __builtin_popcount(state->face_mask[i]);
		faces->gone += __builtin_popcount(state->face_mask[i] & ~faces->first[i]);
		faces->bared += __builtin_popcount(faces->first[i] & ~state->face_mask[i]);
	}
	return CAU_OK;
}
