// SPDX-License-Identifier: GPL-3.0-or-later
// Structured log lines on standard error, one write each, safe from any thread:
//     info 2026-01-31T12:00:00.123Z session=d1-knee event=tool_cut tool=hook cause=watchdog
//     {"level":"info","time":"2026-01-31T12:00:00.123Z","session":"d1-knee","event":"tool_cut",...}
// Under journald (JOURNAL_STREAM is set) each line starts with its syslog priority, such as `<6>`.
#pragma once

#include <stdbool.h>

// Columns: code, name, syslog priority.
#define CAU_LOG_TABLE(X)                                                                           \
	X(DEBUG, "debug", 7)                                                                           \
	X(INFO, "info", 6)                                                                             \
	X(NOTICE, "notice", 5)                                                                         \
	X(WARNING, "warning", 4)                                                                       \
	X(ERROR, "error", 3)

typedef enum cau_log_level {
#define X(code, name, priority) CAU_LOG_##code,
	CAU_LOG_TABLE(X)
#undef X
		CAU_LOG_LEVEL_COUNT
} cau_log_level;

// Sets the lowest level that is logged. Returns false if there is no such level. Any thread may
// call it.
bool cau_log_set_level(const char *name);

// Sets the format of lines: "text" as above, or "json", an object for each line. Returns false if
// there is no such format. Any thread may call it.
bool cau_log_set_format(const char *name);

// Logs one line. `session` may be NULL. `format` makes the `key=value` fields and may be empty.
// Printed values are quoted and escaped where necessary, see line.h.
__attribute__((format(printf, 4, 5))) void cau_log(cau_log_level level, const char *session,
                                                   const char *event, const char *format, ...);
