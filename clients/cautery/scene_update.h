// SPDX-License-Identifier: GPL-3.0-or-later
// A stream's newest state as foxglove.SceneUpdate in JSON: the tissue's present faces as triangles,
// a list for each layer, and each tool as a shaft with a tip, which glows where energy is on. The
// viewer's model/scene_update.ts writes the same.
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "cautery/client.h"

// Needs a stream that is synced and has its topology, with positions, mask and tools. `time_ns`: ns
// since 1970, of the message and of everything in it; the tick and the simulated time are in its
// metadata. Errors: CAU_NO_MEMORY.
cau_status cli_scene_update_write(FILE *out, const cau_client_stream *stream, uint64_t time_ns,
                                  cau_error *error);
