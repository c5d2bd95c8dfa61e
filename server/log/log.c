// SPDX-License-Identifier: GPL-3.0-or-later
#include "log/log.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "log/line.h"

static const struct {
	const char *name;
	int priority;
} levels[] = {
#define X(code, name, priority) {name, priority},
	CAU_LOG_TABLE(X)
#undef X
};

static atomic_int least_level = CAU_LOG_INFO;
static atomic_bool as_json;

bool cau_log_set_level(const char *name)
{
	for (int i = 0; i < CAU_LOG_LEVEL_COUNT; i++)
		if (strcmp(levels[i].name, name) == 0) {
			least_level = i;
			return true;
		}
	return false;
}

bool cau_log_set_format(const char *name)
{
	bool json = strcmp(name, "json") == 0;
	if (!json && strcmp(name, "text") != 0)
		return false;
	as_json = json;
	return true;
}

static void write_head(cau_log_line *line, cau_log_level level)
{
	struct timespec now;
	struct tm utc;
	clock_gettime(CLOCK_REALTIME, &now);
	gmtime_r(&now.tv_sec, &utc);
	char stamp[32], prefix[8] = "";
	strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%S", &utc);
	if (getenv("JOURNAL_STREAM"))
		snprintf(prefix, sizeof prefix, "<%d>", levels[level].priority);
	line->bytes = (size_t)snprintf(line->text, sizeof line->text,
	                               line->json ? "%s{\"level\":\"%s\",\"time\":\"%s.%03ldZ\""
	                                          : "%s%s %s.%03ldZ",
	                               prefix, levels[level].name, stamp, now.tv_nsec / 1000000);
}

static void add(cau_log_line *line, const char *key, const char *value)
{
	cau_log_line_add(line, key, strlen(key), value, strlen(value), false);
}

void cau_log(cau_log_level level, const char *session, const char *event, const char *format, ...)
{
	if ((int)level < least_level)
		return;
	cau_log_line line = {.json = as_json};
	write_head(&line, level);
	add(&line, "session", session && *session ? session : "-");
	add(&line, "event", event);
	va_list arguments;
	va_start(arguments, format);
	cau_log_line_print(&line, format, arguments);
	va_end(arguments);
	cau_log_line_end(&line);
	// If the log cannot be written, there is no way to report it.
	if (write(STDERR_FILENO, line.text, line.bytes) < 0)
		return;
}
