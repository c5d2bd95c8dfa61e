// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a stream's newest state as foxglove.SceneUpdate in JSON. The tissue's present faces are
// triangles, in one list for each layer. Each tool is a shaft with a tip, which glows while energy
// is on. The viewer's model/scene_update.ts writes the same.
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "cautery/client.h"

// The stream must be synced and have its topology, positions, mask and tools. `time_ns` is the time
// of the message and of everything in it, ns since 1970. The metadata have the tick and the
// simulated time. Errors: CAU_NO_MEMORY.
cau_status cli_scene_update_write(FILE *out, const cau_client_stream *stream, uint64_t time_ns,
                                  cau_error *error);
