// SPDX-License-Identifier: GPL-3.0-or-later
// The cut that a scene describes, as a script.
#pragma once

#include <stddef.h>

#include "cautery/scene.h"
#include "cautery/status.h"

// The tool comes from its first pose to above the tissue, is energized, goes down to where the cut
// begins, dwells, is drawn to the cut's end, energy off, and is lifted. Commands as JSON, one a
// line; the caller frees *text. Errors: CAU_BAD_VALUE (no cut, or of a tool that the scene lacks),
// CAU_NO_MEMORY.
cau_status sim_cut_script(const cau_scene_def *scene, char **text, size_t *bytes, cau_error *error);
