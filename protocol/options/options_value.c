// SPDX-License-Identifier: Apache-2.0
// Reads the values of the kinds of options.
#include "options/options_value.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

// Reads a number within the option's bounds. NaN is out of bounds.
static bool read_number(const cau_command_line *line, const cau_option *option, const char *text,
                        double *number, FILE *complaints)
{
	char *end;
	*number = strtod(text, &end);
	if (end != text && *end == 0 && *number >= option->least && *number <= option->most)
		return true;
	fprintf(complaints, "%s: --%s needs a number from %g to %g, not \"%s\"\n", line->program,
	        option->name, option->least, option->most, text);
	return false;
}

static bool read_whole(const cau_command_line *line, const cau_option *option, const char *text,
                       int64_t *whole, FILE *complaints)
{
	double number;
	if (!read_number(line, option, text, &number, complaints))
		return false;
	*whole = (int64_t)number;
	if ((double)*whole == number)
		return true;
	fprintf(complaints, "%s: --%s needs a whole number, not \"%s\"\n", line->program, option->name,
	        text);
	return false;
}

static bool read_choice(const cau_command_line *line, const cau_option *option, const char *text,
                        int *choice, FILE *complaints)
{
	for (*choice = 0; option->choices[*choice]; ++*choice)
		if (strcmp(option->choices[*choice], text) == 0)
			return true;
	fprintf(complaints, "%s: --%s is one of", line->program, option->name);
	for (int i = 0; option->choices[i]; i++)
		fprintf(complaints, "%s %s", i ? "," : "", option->choices[i]);
	fprintf(complaints, "; not \"%s\"\n", text);
	return false;
}

static bool read_point(const cau_command_line *line, const cau_option *option, const char *text,
                       double point[3], FILE *complaints)
{
	const char *next = text;
	for (int i = 0; i < 3; i++) {
		char *end;
		point[i] = strtod(next, &end);
		if (end == next || *end != (i < 2 ? ',' : 0) || !isfinite(point[i])) {
			fprintf(complaints, "%s: --%s needs three numbers X,Y,Z, not \"%s\"\n", line->program,
			        option->name, text);
			return false;
		}
		next = end + 1;
	}
	return true;
}

bool cau_option_read_value(const cau_command_line *line, const cau_option *option,
                           const char *value, void *member, FILE *complaints)
{
	int64_t whole;
	switch (option->kind) {
	case CAU_OPTION_FLAG:
	case CAU_OPTION_HELP:
		return *(bool *)member = true;
	case CAU_OPTION_TEXT:
		*(const char **)member = value;
		return true;
	case CAU_OPTION_NUMBER:
		return read_number(line, option, value, member, complaints);
	case CAU_OPTION_WHOLE:
		if (!read_whole(line, option, value, &whole, complaints))
			return false;
		CAU_ASSERT(whole >= INT32_MIN && whole <= INT32_MAX, "the bounds of --%s", option->name);
		*(int32_t *)member = (int32_t)whole;
		return true;
	case CAU_OPTION_LONG:
		return read_whole(line, option, value, member, complaints);
	case CAU_OPTION_CHOICE:
		return read_choice(line, option, value, member, complaints);
	case CAU_OPTION_POINT:
		return read_point(line, option, value, member, complaints);
	}
	return false;
}
