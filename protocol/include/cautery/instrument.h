// SPDX-License-Identifier: Apache-2.0
// Profiles of instruments: shape, sizes and blade of an instrument, and the settings of its
// generator in each mode. They are the files of deploy/instruments, which the library contains. A
// tool of a scene, tool.add and tool.configure may name an instrument and a mode. Readers put the
// numbers in their place, so that sessions, logs and snapshots hold numbers alone.
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

enum { CAU_MAX_MODES = 8 }; // of an instrument

// A mode of an instrument.
typedef struct cau_instrument_mode {
	char name[CAU_NAME_BYTES];        // of the mode: cut, blend, level-3
	char description[CAU_TEXT_BYTES]; // in words
	double power_least_w;             // the range of power_w in this mode
	double power_most_w;              // its upper end
	cau_tool_def tool; // the instrument with the mode's settings; no name, the default pose
} cau_instrument_mode;

// An instrument with all its modes.
typedef struct cau_instrument {
	char name[CAU_NAME_BYTES];                // of the instrument
	char description[CAU_TEXT_BYTES];         // in words
	int32_t mode_count;                       // at least 1
	cau_instrument_mode modes[CAU_MAX_MODES]; // (mode_count); the first is the default
} cau_instrument;

// How many instruments there are.
int32_t cau_instrument_count(void);
// The name of one, 0 to cau_instrument_count() - 1, in the order of the alphabet.
const char *cau_instrument_name(int32_t index);
// Reads one, 0 to cau_instrument_count() - 1. Errors: those of a file that is no profile, which the
// library's own files are not; CAU_NO_MEMORY.
cau_status cau_instrument_read(int32_t index, cau_instrument *instrument, cau_error *error);

// Reads a profile's text. `name` is the file's name without its ending, which the profile must
// have. Errors: CAU_BAD_SYNTAX, CAU_LIMIT, CAU_NO_MEMORY; CAU_BAD_VALUE with the path of the
// member, also where a number has no source.
cau_status cau_instrument_from_json(const char *name, const char *text, size_t bytes,
                                    cau_instrument *instrument, cau_error *error);

// Gives *tool the shape, sizes and settings of an instrument in a mode; its name and pose stay.
// `mode` may be NULL or empty: the first. `power_w` is in the mode's range, or below 0: the mode's
// own power. Errors: CAU_BAD_VALUE, with path instrument or mode and all known names, or with path
// power_w; CAU_NO_MEMORY. After an error *tool is as before.
cau_status cau_instrument_take(const char *instrument, const char *mode, double power_w,
                               cau_tool_def *tool, cau_error *error);

#ifdef __cplusplus
}
#endif
