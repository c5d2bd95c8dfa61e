// SPDX-License-Identifier: GPL-3.0-or-later
// From a scene as JSON to a session, for programs that contain the core. cautery/session.h has all
// else.
//
//     #include "cautery/embed.h"
//
//     // Runs the scene of a file for a second; the hash of its state then, or 0.
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
// Threads: these functions share nothing. A session is used from one thread at a time.
#pragma once

#include <stddef.h>

#include "cautery/session.h"

#ifdef __cplusplus
extern "C" {
#endif

// The version of the library, "0.1.0". Before version 1, only an equal one has the same structs.
const char *cau_core_version(void);

// Fills *scene from a scene file, of CAU_SCENE_JSON_MAX_BYTES at most. Mesh files that it names are
// looked up beside it. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY and those of cau_scene_from_json;
// error->file is `path`.
cau_status cau_scene_from_file(const char *path, cau_scene_def *scene, cau_error *error);

// Makes a session of a scene file. `def` is NULL for the defaults; its `scene` is not read. The
// caller destroys *session. Errors: those of cau_scene_from_file and cau_session_create;
// error->file is `path`.
cau_status cau_session_from_file(const char *path, const cau_session_def *def,
                                 cau_session **session, cau_error *error);

// The same of a scene's text, `byte_count` bytes. `name` is what errors call it (NULL: nothing).
// Mesh files that it names are looked up in `directory` (NULL: where the program runs).
cau_status cau_session_from_json(const char *name, const char *text, size_t byte_count,
                                 const char *directory, const cau_session_def *def,
                                 cau_session **session, cau_error *error);

// Queues a command as JSON: cautery/command_json.h has the members. Errors: those of
// cau_command_from_json and cau_session_submit.
cau_status cau_session_submit_json(cau_session *session, const char *text, size_t byte_count,
                                   cau_error *error);

#ifdef __cplusplus
}
#endif
