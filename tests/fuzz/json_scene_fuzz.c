// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for scenes. An accepted scene can be written, and reading the text gives the same
// scene.
#include <stdlib.h>
#include <string.h>

#include "cautery/scene_json.h"
#include "fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static cau_scene_def first, second;
	static char text[CAU_SCENE_JSON_MAX_BYTES];
	cau_error error = {0};
	size_t written = 0;
	if (cau_scene_from_json("fuzz", (const char *)data, bytes, &first, &error)) {
		if (error.reason[0] == 0 || error.status == CAU_OK)
			abort();
		return 0;
	}
	if (cau_scene_to_json(&first, text, sizeof text, &written, &error) ||
	    cau_scene_from_json("fuzz", text, written, &second, &error) ||
	    memcmp(&first, &second, sizeof first) != 0)
		abort();
	return 0;
}
