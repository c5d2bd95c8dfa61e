// SPDX-License-Identifier: Apache-2.0
// Describes a program's command line in one table. Reading, --help and error messages all use it.
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

// The kind of an option's value, which also gives the type of its member.
typedef enum cau_option_kind {
	CAU_OPTION_FLAG, // bool, true if the option is given; takes no value
	// bool, like FLAG; if the option is given, all other arguments are ignored. -h means the first
	// HELP option
	CAU_OPTION_HELP,
	CAU_OPTION_TEXT,   // const char *, which points into the arguments
	CAU_OPTION_NUMBER, // double, from `least` to `most`
	CAU_OPTION_WHOLE,  // int32_t, from `least` to `most`
	CAU_OPTION_LONG,   // int64_t, from `least` to `most`, at most 2^53
	CAU_OPTION_CHOICE, // int, index in `choices`
	CAU_OPTION_POINT,  // double[3], written X,Y,Z
} cau_option_kind;

// One option of a program.
typedef struct cau_option {
	const char *name;           // the option's name without the dashes
	const char *argument;       // name of the value in --help; NULL if the option takes no value
	cau_option_kind kind;       // kind of the value
	size_t member;              // offset of the member that gets the value
	double least, most;         // inclusive range of a number
	const char *const *choices; // words of a choice; NULL marks the end
	const char *meaning;        // description in --help; may have several lines
} cau_option;

// A program's whole command line. All pointers are borrowed.
typedef struct cau_command_line {
	const char *program; // the program's name in messages
	// the words after the options, for --help and messages; NULL if there are none
	const char *words;
	int word_count;         // number of these words
	const char *summary;    // purpose of the program, in whole lines
	const char *closing;    // lines after the options in --help, such as exit codes, or NULL
	const cau_option *rows; // `row_count` options
	int row_count;          // number of options
} cau_command_line;

// Reads the arguments from arguments[1]. Options are `--name value` or `--name=value`, before,
// between or after the words. After `--` all arguments are words. `into` must hold the defaults;
// options that are given overwrite them. `words` gets word_count words. On a mistake it prints on
// `complaints` the error and the allowed values, and returns false; `into` may then be partly
// written.
bool cau_options_read(const cau_command_line *line, int argument_count, char **arguments,
                      void *into, const char **words, FILE *complaints);

// Prints the text of --help.
void cau_options_help(const cau_command_line *line, FILE *out);

#ifdef __cplusplus
}
#endif
