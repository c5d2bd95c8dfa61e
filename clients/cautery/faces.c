// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/faces.h"

#include <stdlib.h>
#include <string.h>

void cli_faces_finish(cli_faces *faces)
{
	free(faces->first);
	*faces = (cli_faces){0};
}

static cau_status begin(cli_faces *faces, const cau_stream_state *state, size_t words)
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
	if ((!faces->first || faces->epoch != state->epoch) && begin(faces, state, words))
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
