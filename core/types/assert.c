// SPDX-License-Identifier: Apache-2.0
// The end of a program that broke its own rules. The only place in core and protocol that writes to
// the console or ends the process; Release builds never come here.
#include "cautery/assert.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { WORDS_BYTES = 512 }; // of the sentence; longer ones are cut

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
