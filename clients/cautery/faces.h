// SPDX-License-Identifier: GPL-3.0-or-later
// Counts faces that appear and disappear, relative to the first state that was seen in an epoch.
// When fat is removed, inner faces appear: they are bared.
#pragma once

#include <stdint.h>

#include "cautery/stream.h"

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
