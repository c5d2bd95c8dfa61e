// SPDX-License-Identifier: Apache-2.0
// Profiles of instruments. A profile has the shape, sizes and blade of an instrument, and the
// settings of its generator in each mode. The library contains the profiles of deploy/instruments.
// A tool of a scene, tool.add and tool.configure may name an instrument and a mode. Readers replace
// the name by the profile's numbers, so sessions, logs and snapshots contain only numbers.
//
//     #include "cautery/defaults.h"
//     #include "cautery/instrument.h"
//
//     // A hook that cuts with 20 W.
//     static cau_status make_hook(cau_tool_def *tool, cau_error *error)
//     {
//         cau_default_tool_def(tool, CAU_TOOL_HOOK);
//         return cau_instrument_take("monopolar-hook", "cut", 20, tool, error);
//     }
#pragma once

#include <stdint.h>

#include "cautery/scene.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CAU_MAX_MODES = 8 }; // largest number of modes of an instrument

// A mode of an instrument.
typedef struct cau_instrument_mode {
	char name[CAU_NAME_BYTES];        // such as cut, blend or level-3
	char description[CAU_TEXT_BYTES]; // description for people
	double power_least_w;             // lower end of the range of power_w in this mode
	double power_most_w;              // upper end of the range of power_w
	// the instrument with the mode's settings, without a name, in the default pose
	cau_tool_def tool;
} cau_instrument_mode;

// An instrument with all its modes.
typedef struct cau_instrument {
	char name[CAU_NAME_BYTES];                // name of the instrument
	char description[CAU_TEXT_BYTES];         // description for people
	int32_t mode_count;                       // number of modes, at least 1
	cau_instrument_mode modes[CAU_MAX_MODES]; // `mode_count` modes; mode 0 is the default
} cau_instrument;

// Returns the number of instruments.
int32_t cau_instrument_count(void);
// Returns the name of instrument `index`, 0 to cau_instrument_count() - 1, in alphabetical order.
const char *cau_instrument_name(int32_t index);
// Reads instrument `index`, 0 to cau_instrument_count() - 1. Errors: CAU_NO_MEMORY. The errors of
// an invalid profile do not occur with the library's own files.
cau_status cau_instrument_read(int32_t index, cau_instrument *instrument, cau_error *error);

// Reads a profile's text. `name` is the file's name without its ending, and must be the profile's
// name. Errors: CAU_BAD_SYNTAX, CAU_LIMIT, CAU_NO_MEMORY; CAU_BAD_VALUE with the path of the
// member, also if a number has no source.
cau_status cau_instrument_from_json(const char *name, const char *text, size_t bytes,
                                    cau_instrument *instrument, cau_error *error);

// Gives *tool the shape, sizes and settings of an instrument in a mode. The tool's name and pose
// stay. If `mode` is NULL or empty, the first mode is used. If `power_w` is negative, the mode's
// own power is used; otherwise it must be in the mode's range. Errors: CAU_BAD_VALUE, with path
// instrument or mode and all known names, or with path power_w; CAU_NO_MEMORY. After an error *tool
// is unchanged.
cau_status cau_instrument_take(const char *instrument, const char *mode, double power_w,
                               cau_tool_def *tool, cau_error *error);

#ifdef __cplusplus
}
#endif
