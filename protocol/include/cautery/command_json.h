// SPDX-License-Identifier: Apache-2.0
// Commands as JSON. Messages, logs and scripts use the same form:
//
//     {"tick": 60, "command": "tool.move", "tool": "hook",
//      "position_m": [0, 0, 0.002], "rotation": [1, 0, 0, 0], "jaw": 0}
//
// All commands have "command", "tick" (default 0: at once) and "sequence" (default 0). The other
// members depend on the command; a default is in parentheses:
//     tool.add         name, shape, and the optional members of a scene's tool
//     tool.remove      tool
//     tool.configure   tool, shape, and sizes as in a scene's tool. All sizes are replaced; absent
//                      sizes get the defaults, or the sizes of `instrument` in `mode`
//     tool.move        tool, position_m, rotation, jaw (0)
//     tool.energize    tool, energized (true or false), ticks (of an enable: its duration)
//     tool.grasp       tool
//     tool.release     tool
//     tool.hold        tool
//     pin, unpin       selection
//     material.set     layer, kind (of the layer), region (0), and the members of such a material
//     gravity.set      gravity_m_s2
//     force.set        selection, force_n
// Rotations are quaternions w, x, y, z, within 1e-3 of unit length; they are normalised.
//
//     #include "cautery/command_json.h"
//
//     // Returns the number of commands in a script, or -1 with the bad line in *error.
//     static int64_t count_commands(const char *text, size_t bytes, cau_error *error)
//     {
//         cau_script script;
//         cau_command command;
//         bool end = false;
//         cau_script_begin(&script, "script", text, bytes);
//         for (int64_t count = 0;; count++) {
//             if (cau_script_next(&script, &command, &end, error))
//                 return -1;
//             if (end)
//                 return count;
//         }
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/command.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CAU_COMMAND_JSON_MAX_BYTES = 16384 }; // largest text of one command

// Reads a command. Errors: CAU_BAD_SYNTAX, CAU_LIMIT, CAU_NO_MEMORY, CAU_BAD_VALUE with the
// member's path.
cau_status cau_command_from_json(const char *text, size_t bytes, cau_command *command,
                                 cau_error *error);

// Writes a command as one line without a line end, with every member that its kind has. See
// cau_scene_to_json for `bytes`.
cau_status cau_command_to_json(const cau_command *command, char *buffer, size_t capacity,
                               size_t *bytes, cau_error *error);

// A script has one command as JSON on each line. Ticks never decrease. Empty lines are skipped.
typedef struct cau_script {
	const char *name; // copied to error->file; may be NULL
	const char *text; // borrowed
	size_t bytes;     // size of `text`
	size_t offset;    // offset of the next line
	int32_t line;     // number of the last read line, from 1
	uint64_t tick;    // tick of the last read command
} cau_script;

// Begins at the first line of `text`. Both `text` and `name` are borrowed.
void cau_script_begin(cau_script *script, const char *name, const char *text, size_t bytes);

// Reads the next command. After the last one, *end is true and *command is unchanged. The reason of
// an error starts with the script's line. Reading may continue after an error.
cau_status cau_script_next(cau_script *script, cau_command *command, bool *end, cau_error *error);

#ifdef __cplusplus
}
#endif
