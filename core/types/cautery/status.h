// SPDX-License-Identifier: Apache-2.0
// Status codes and error reports, shared by core and protocol.
//
//     #include "cautery/status.h"
//
//     static cau_status check_speed(double speed_m_s, cau_error *error)
//     {
//         if (speed_m_s >= 0 && speed_m_s <= 5)
//             return CAU_OK;
//         return cau_fail(error, CAU_BAD_VALUE, "speed_m_s", "%g is not within 5 m/s", speed_m_s);
//     }
//
//     static void report(const cau_error *error)
//     {
//         printf("%s: %s: %s\n", cau_status_name(error->status), error->path, error->reason);
//     }
#pragma once

#include <stdarg.h>
#include <stdio.h>

// The entries: code, wire name, sentence.
#define CAU_STATUS_TABLE(X)                                                                        \
	X(OK, "ok", "done")                                                                            \
	X(BAD_VALUE, "bad_value", "a value is missing, of the wrong type or out of its range")         \
	X(BAD_SYNTAX, "bad_syntax", "the text is not well formed")                                     \
	X(BAD_MESH, "bad_mesh", "the mesh cannot be simulated")                                        \
	X(BAD_STATE, "bad_state", "the request does not fit the present state")                        \
	X(NOT_FOUND, "not_found", "nothing has this name")                                             \
	X(ALREADY_EXISTS, "already_exists", "the name is taken")                                       \
	X(LIMIT, "limit", "a configured limit is reached")                                             \
	X(UNSUPPORTED, "unsupported", "this build cannot do that")                                     \
	X(NO_MEMORY, "no_memory", "memory ran out")                                                    \
	X(IO, "io", "a file could not be read or written")                                             \
	X(NUMERICAL, "numerical", "the simulation failed numerically")                                 \
	X(FAULTED, "faulted", "the session is faulted: rewind or reset it")                            \
	X(CORRUPT, "corrupt", "the data is damaged or of another version")

// The result of a function. CAU_OK is 0.
typedef enum cau_status {
#define X(code, name, sentence) CAU_##code,
	CAU_STATUS_TABLE(X)
#undef X
		CAU_STATUS_COUNT
} cau_status;

// What went wrong, where, and why. `path` is a path inside a document ("layers[1].poisson_ratio");
// `file` names the document; either may be empty.
typedef struct cau_error {
	cau_status status; // kind of the error
	char file[256];    // name of the document
	char path[160];    // path inside the document
	char reason[320];  // a sentence: what is wrong, and what would be right
} cau_error;

// Returns the word of a status on the wire, "unknown" for an invalid status.
static inline const char *cau_status_name(cau_status status)
{
	static const char *const names[] = {
#define X(code, name, sentence) name,
		CAU_STATUS_TABLE(X)
#undef X
	};
	return (unsigned)status < CAU_STATUS_COUNT ? names[status] : "unknown";
}

// Returns a sentence that describes a status.
static inline const char *cau_status_sentence(cau_status status)
{
	static const char *const sentences[] = {
#define X(code, name, sentence) sentence,
		CAU_STATUS_TABLE(X)
#undef X
	};
	return (unsigned)status < CAU_STATUS_COUNT ? sentences[status] : "unknown status";
}

// Fills *error (which may be NULL) and returns `status`, so that a function can `return
// cau_fail(...)`. `path` may be NULL. The file name already in *error is kept.
__attribute__((format(printf, 4, 5))) static inline cau_status
cau_fail(cau_error *error, cau_status status, const char *path, const char *format, ...)
{
	if (error) {
		error->status = status;
		snprintf(error->path, sizeof error->path, "%s", path ? path : "");
		va_list arguments;
		va_start(arguments, format);
		vsnprintf(error->reason, sizeof error->reason, format, arguments);
		va_end(arguments);
	}
	return status;
}

#ifdef __clang_analyzer__
// The analyzer does not look into functions with variable arguments. This macro shows the result to
// the analyzer.
#define cau_fail(error, status, ...) ((void)(cau_fail)((error), (status), __VA_ARGS__), (status))
#endif
