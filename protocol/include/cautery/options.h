// SPDX-License-Identifier: Apache-2.0
// A program's command line as one table. Reading, --help and complaints use the same entries.
//
//     #include <stddef.h>
//
//     #include "cautery/options.h"
//
//     typedef struct asked {
//         const char *scene;
//         int32_t threads;
//         bool help;
//     } asked;
//
//     static const cau_option rows[] = {
//         {"scene", "NAME", CAU_OPTION_TEXT, offsetof(asked, scene),
//          .meaning = "what to run"},
//         {"threads", "N", CAU_OPTION_WHOLE, offsetof(asked, threads), 1, 16,
//          .meaning = "1 to 16"},
//         {"help", NULL, CAU_OPTION_HELP, offsetof(asked, help), .meaning = "this text"},
//     };
//     static const cau_command_line line = {
//         .program = "example", .summary = "Runs a scene.\n", .rows = rows, .row_count = 3};
//
//     static bool read(asked *to, int argument_count, char **arguments)
//     {
//         *to = (asked){.scene = "fat", .threads = 1};
//         return cau_options_read(&line, argument_count, arguments, to, NULL, stderr);
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

// What an option's value is, and with it the type of the member that it is read into.
typedef enum cau_option_kind {
	CAU_OPTION_FLAG,   // bool: true where it is named; takes no value
	CAU_OPTION_HELP,   // bool: as FLAG; other arguments are then ignored. -h is the first one
	CAU_OPTION_TEXT,   // const char *, which points into the arguments
	CAU_OPTION_NUMBER, // double, from `least` to `most`
	CAU_OPTION_WHOLE,  // int32_t, from `least` to `most`
	CAU_OPTION_LONG,   // int64_t, from `least` to `most`, at most 2^53
	CAU_OPTION_CHOICE, // int: which of `choices`
	CAU_OPTION_POINT,  // double[3], written X,Y,Z
} cau_option_kind;

// One option of a program.
typedef struct cau_option {
	const char *name;           // without its dashes
	const char *argument;       // what --help calls its value; NULL where it takes none
	cau_option_kind kind;       // what its value is
	size_t member;              // offset of what it is read into
	double least, most;         // of a number; both included
	const char *const *choices; // of a choice; ends with NULL
	const char *meaning;        // in --help; may have several lines
} cau_option;

// All of a program's command line. Everything is borrowed.
typedef struct cau_command_line {
	const char *program; // as it calls itself in complaints
	const char *words; // what follows the options, as --help and a complaint say it; NULL: nothing
	int word_count;    // as many as that are
	const char *summary; // what the program does: whole lines
	const char *closing; // after the options in --help, such as exit codes: whole lines; NULL: none
	const cau_option *rows; // (row_count)
	int row_count;          // options of the program
} cau_command_line;

// Reads arguments[1] and on. Options are `--name value` or `--name=value`, before, between or after
// the words; after `--` all are words. `into` holds the defaults and is written where an option is
// named; `words` takes word_count words. False after a line on `complaints` that says what is wrong
// and what would be right; `into` is in part written then.
bool cau_options_read(const cau_command_line *line, int argument_count, char **arguments,
                      void *into, const char **words, FILE *complaints);

// Writes what --help prints.
void cau_options_help(const cau_command_line *line, FILE *out);

#ifdef __cplusplus
}
#endif
