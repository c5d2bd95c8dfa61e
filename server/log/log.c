// SPDX-License-Identifier: GPL-3.0-or-later
#include "log/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { LINE_BYTES = 1024 };

static const struct {
	const char *name;
	int priority;
} levels[] = {
#define X(code, name, priority) {name, priority},
	CAU_LOG_TABLE(X)
#undef X
};

static cau_log_level least_level = CAU_LOG_INFO;

bool cau_log_set_level(const char *name)
{
	for (int i = 0; i < CAU_LOG_LEVEL_COUNT; i++)
		if (strcmp(levels[i].name, name) == 0) {
			least_level = (cau_log_level)i;
			return true;
		}
	return false;
}

static size_t write_head(char *line, cau_log_level level, const char *session, const char *event)
{
	struct timespec now;
	struct tm utc;
	clock_gettime(CLOCK_REALTIME, &now);
	gmtime_r(&now.tv_sec, &utc);
	char stamp[32], prefix[8] = "";
	strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%S", &utc);
	if (getenv("JOURNAL_STREAM"))
		snprintf(prefix, sizeof prefix, "<%d>", levels[level].priority);
	int length = snprintf(line, LINE_BYTES, "%s%s %s.%03ldZ session=%.64s event=%.64s", prefix,
	                      levels[level].name, stamp, now.tv_nsec / 1000000,
	                      session && *session ? session : "-", event);
	return (size_t)length;
}

void cau_log(cau_log_level level, const char *session, const char *event, const char *format, ...)
{
	if (level < least_level)
		return;
	char line[LINE_BYTES];
	size_t length = write_head(line, level, session, event);
	if (*format) {
		line[length++] = ' ';
		va_list arguments;
		va_start(arguments, format);
		int added = vsnprintf(line + length, sizeof line - length - 1, format, arguments);
		va_end(arguments);
		size_t room = sizeof line - length - 2;
		length += added < 0 ? 0 : (size_t)added < room ? (size_t)added : room;
	}
	for (size_t i = 0; i < length; i++)
		if ((unsigned char)line[i] < 0x20 || line[i] == 0x7f)
			line[i] = '?';
	line[length++] = '\n';
	// A log that cannot be written has nowhere to be reported.
	if (write(STDERR_FILENO, line, length) < 0)
		return;
}
