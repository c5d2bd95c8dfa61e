// SPDX-License-Identifier: Apache-2.0
// Ends a program that broke its own rules. Only this file of core and protocol writes to the
// console or ends the process. A release build comes here only for a safety rule that is broken
// outside every guard.
#include "cautery/assert.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS_BYTES = 512 }; // size of the message; longer messages are cut

void cau_assert_failed(const char *condition, const char *file, int line, const char *function,
                       const char *format, ...)
{
	char words[WORDS_BYTES];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(words, sizeof words, format, arguments);
	va_end(arguments);
	fprintf(stderr, "%s:%d: %s: %s does not hold: %s\n", file, line, function, condition, words);
	abort();
}

// ---- safety rules -------------------------------------------------------------------------------

static _Thread_local cau_rule_guard *innermost;

void cau_rule_enter(cau_rule_guard *guard)
{
	guard->outer = innermost;
	guard->reason[0] = 0;
	innermost = guard;
}

void cau_rule_leave(cau_rule_guard *guard)
{
	CAU_ASSERT(innermost == guard, "a guard is left that another lies in: %s", guard->reason);
	innermost = guard->outer;
}

// Returns the file's name without its folders, because the readers of a log do not know the build
// tree.
static const char *base_of(const char *file)
{
	const char *slash = strrchr(file, '/');
	return slash ? slash + 1 : file;
}

void cau_rule_broken(const char *condition, const char *file, int line, const char *function,
                     const char *format, ...)
{
	char words[CAU_RULE_REASON_BYTES];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(words, sizeof words, format, arguments);
	va_end(arguments);
	if (!innermost)
		cau_assert_failed(condition, file, line, function, "%s", words);
	snprintf(innermost->reason, sizeof innermost->reason, "%.40s:%d: %.60s does not hold: %.180s",
	         base_of(file), line, condition, words);
	longjmp(innermost->place, 1);
}
