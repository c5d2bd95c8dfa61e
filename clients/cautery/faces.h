// SPDX-License-Identifier: GPL-3.0-or-later
// Faces come and go: where fat is removed, its inner faces are bared. What is counted is the
// difference to the first state seen of an epoch.
#pragma once

#include <stdint.h>

#include "cautery/stream.h"

typedef struct cli_faces {
	uint32_t *first; // mask of the first state; NULL: none seen yet
	uint64_t epoch;
	int64_t drawn; // now
	int64_t gone;  // drawn at first, not now
	int64_t bared; // not drawn at first, but now
} cli_faces;

// Errors: CAU_NO_MEMORY; the counts are zero then.
cau_status cli_faces_count(cli_faces *faces, const cau_stream_state *state, int32_t face_count);
void cli_faces_finish(cli_faces *faces);
