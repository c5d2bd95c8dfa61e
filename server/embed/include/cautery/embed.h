// SPDX-License-Identifier: GPL-3.0-or-later
// Creates sessions from scenes in JSON, for programs that contain the core. All other functions of
// a session are in cautery/session.h.
//
//     #include "cautery/embed.h"
//
//     // Runs the scene of a file for a second. Returns the hash of its state, or 0.
//     static uint64_t run(const char *path, cau_error *error)
//     {
//         cau_session *session = NULL;
//         if (cau_session_from_file(path, NULL, &session, error))
//             return 0;
//         const char up[] = "{\"command\": \"tool.move\", \"tool\": \"hook\","
//                           " \"position_m\": [0, 0, 0.05], \"rotation\": [1, 0, 0, 0]}";
//         cau_status status = cau_session_submit_json(session, up, sizeof up - 1, error);
//         for (int tick = 0; tick < 60 && !status; tick++)
//             status = cau_session_step(session, error);
//         uint64_t hash = status ? 0 : cau_session_hash(session);
//         cau_session_destroy(session);
//         return hash;
//     }
//
// Threads: the functions share no state. One thread at a time may use a session.
#pragma once

#include <stddef.h>

#include "cautery/session.h"

#ifdef __cplusplus
extern "C" {
#endif

// Returns the version of the library, such as "0.1.0". Before version 1, the structs are the same
// only if the version is equal.
const char *cau_core_version(void);

// Fills *scene from a scene file of at most CAU_SCENE_JSON_MAX_BYTES. Names of mesh files in it are
// relative to its folder. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY and those of
// cau_scene_from_json; error->file is `path`.
cau_status cau_scene_from_file(const char *path, cau_scene_def *scene, cau_error *error);

// Creates a session from a scene file. `def` is NULL for the defaults; def->scene is ignored. The
// caller destroys *session. Errors: those of cau_scene_from_file and cau_session_create;
// error->file is `path`.
cau_status cau_session_from_file(const char *path, const cau_session_def *def,
                                 cau_session **session, cau_error *error);

// Creates a session from the text of a scene, `byte_count` bytes. Errors call it `name` (NULL: no
// name). Names of mesh files in it are relative to `directory` (NULL: the working directory).
// Otherwise like cau_session_from_file.
cau_status cau_session_from_json(const char *name, const char *text, size_t byte_count,
                                 const char *directory, const cau_session_def *def,
                                 cau_session **session, cau_error *error);

// Queues a command in JSON; cautery/command_json.h has the members. Errors: those of
// cau_command_from_json and cau_session_submit.
cau_status cau_session_submit_json(cau_session *session, const char *text, size_t byte_count,
                                   cau_error *error);

#ifdef __cplusplus
}
#endif
