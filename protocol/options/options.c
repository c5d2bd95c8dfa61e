// SPDX-License-Identifier: Apache-2.0
// Reads a command line and prints --help.
#include "cautery/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/nearest.h"

// ---- values
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

static bool read_value(const cau_command_line *line, const cau_option *option, const char *value,
                       void *member, FILE *complaints)
{
	int64_t whole;
	bool flag = option->kind == CAU_OPTION_FLAG || option->kind == CAU_OPTION_HELP;
	CAU_ASSERT(flag == !value, "--%s: only a flag has no value", option->name);
	(void)flag;
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

enum {
	MOST_ROWS = 32,
	LEFT_BYTES = 40, // size of the text for an option and its argument in --help
};

// ---- help --------------------------------------------------------------------------------------
static void write_left(const cau_option *option, char left[LEFT_BYTES])
{
	int bytes = snprintf(left, LEFT_BYTES, "--%s%s%s", option->name, option->argument ? " " : "",
	                     option->argument ? option->argument : "");
	CAU_ASSERT(bytes < LEFT_BYTES, "--%s is too long for --help", option->name);
	(void)bytes;
}

static int widest(const cau_command_line *line)
{
	int most = 0;
	for (int i = 0; i < line->row_count; i++) {
		char left[LEFT_BYTES];
		write_left(&line->rows[i], left);
		most = (int)strlen(left) > most ? (int)strlen(left) : most;
	}
	return most;
}

// Prints the meaning beside the option. Further lines are printed below the first line.
static void print_meaning(FILE *out, const char *left, int width, const char *meaning)
{
	for (const char *next = meaning; next;) {
		size_t bytes = strcspn(next, "\n");
		fprintf(out, "  %-*s  %.*s\n", width, left, (int)bytes, next);
		left = "";
		next = next[bytes] ? next + bytes + 1 : NULL;
	}
}

void cau_options_help(const cau_command_line *line, FILE *out)
{
	int width = widest(line);
	fprintf(out, "%s [options]%s%s\n%s\n", line->program, line->words ? " " : "",
	        line->words ? line->words : "", line->summary);
	for (int i = 0; i < line->row_count; i++) {
		char left[LEFT_BYTES];
		write_left(&line->rows[i], left);
		print_meaning(out, left, width, line->rows[i].meaning);
	}
	if (line->closing)
		fprintf(out, "\n%s", line->closing);
}

// ---- reading -----------------------------------------------------------------------------------
static void complain_unknown(const cau_command_line *line, const char *name, size_t bytes,
                             FILE *complaints)
{
	const char *names[MOST_ROWS];
	char wrong[LEFT_BYTES];
	snprintf(wrong, sizeof wrong, "%.*s", (int)bytes, name);
	for (int i = 0; i < line->row_count; i++)
		names[i] = line->rows[i].name;
	const char *nearest = cau_nearest(wrong, names, (size_t)line->row_count);
	fprintf(complaints, "%s: there is no option --%s", line->program, wrong);
	if (nearest)
		fprintf(complaints, ": did you mean --%s?\n", nearest);
	else
		fputs(" (--help lists them)\n", complaints);
}

static const cau_option *find_option(const cau_command_line *line, const char *name, size_t bytes)
{
	for (int i = 0; i < line->row_count; i++)
		if (strlen(line->rows[i].name) == bytes && strncmp(line->rows[i].name, name, bytes) == 0)
			return &line->rows[i];
	return NULL;
}

static const cau_option *find_help(const cau_command_line *line)
{
	for (int i = 0; i < line->row_count; i++)
		if (line->rows[i].kind == CAU_OPTION_HELP)
			return &line->rows[i];
	return NULL;
}

// The state while a command line is read.
typedef struct reading {
	const cau_command_line *line;
	char **arguments;
	int argument_count, at; // `at` is the index of the present argument
	char *into;
	const char **words;
	int word_count;
	bool words_only; // the argument `--` was found
	bool helped;
	FILE *complaints;
} reading;

static bool take_word(reading *r)
{
	const char *word = r->arguments[r->at];
	if (r->word_count == r->line->word_count) {
		fprintf(r->complaints, "%s: the argument \"%s\" is not expected here\n", r->line->program,
		        word);
		return false;
	}
	r->words[r->word_count++] = word;
	return true;
}

static bool take_option(reading *r)
{
	const char *name = r->arguments[r->at] + 2;
	size_t bytes = strcspn(name, "=");
	const cau_option *option = find_option(r->line, name, bytes);
	if (!option) {
		complain_unknown(r->line, name, bytes, r->complaints);
		return false;
	}
	const char *value = name[bytes] ? name + bytes + 1 : NULL;
	if (option->argument && !value && r->at + 1 < r->argument_count)
		value = r->arguments[++r->at];
	if (!option->argument != !value) {
		fprintf(r->complaints, "%s: --%s %s\n", r->line->program, option->name,
		        option->argument ? "needs a value" : "takes no value");
		return false;
	}
	r->helped = r->helped || option->kind == CAU_OPTION_HELP;
	return read_value(r->line, option, value, r->into + option->member, r->complaints);
}

static bool take_argument(reading *r)
{
	const char *argument = r->arguments[r->at];
	const cau_option *help = find_help(r->line);
	if (r->words_only || strncmp(argument, "-", 1) != 0)
		return take_word(r);
	if (strcmp(argument, "--") == 0)
		return r->words_only = true;
	if (strncmp(argument, "--", 2) == 0)
		return take_option(r);
	if (help && strcmp(argument, "-h") == 0) {
		r->helped = true;
		return read_value(r->line, help, NULL, r->into + help->member, r->complaints);
	}
	return take_word(r);
}

bool cau_options_read(const cau_command_line *line, int argument_count, char **arguments,
                      void *into, const char **words, FILE *complaints)
{
	CAU_ASSERT(line->row_count <= MOST_ROWS, "%d options", line->row_count);
	CAU_ASSERT(!line->word_count == !line->words, "%d words", line->word_count);
	reading r = {.line = line,
	             .arguments = arguments,
	             .argument_count = argument_count,
	             .into = into,
	             .words = words,
	             .complaints = complaints};
	for (r.at = 1; r.at < argument_count && !r.helped; r.at++)
		if (!take_argument(&r))
			return false;
	if (r.helped || r.word_count == line->word_count)
		return true;
	fprintf(complaints, "%s: needs the arguments %s (see --help)\n", line->program, line->words);
	return false;
}
