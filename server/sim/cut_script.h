// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a script of the cut that a scene describes.
#pragma once

#include <stddef.h>

#include "cautery/scene.h"
#include "cautery/status.h"

// Makes the script. The tool comes from its first pose to a point above the tissue. Its energy goes
// on, and it goes down to the start of the cut and dwells. It is drawn to the cut's end, energy
// goes off, and it is lifted. The script has one JSON command on each line; the caller frees *text.
// Errors: CAU_BAD_VALUE (the scene has no cut, or not the cut's tool), CAU_NO_MEMORY.
cau_status sim_cut_script(const cau_scene_def *scene, char **text, size_t *bytes, cau_error *error);
