// SPDX-License-Identifier: GPL-3.0-or-later
// The options of cautery-load.
#pragma once

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Exit codes, as --help states them.
typedef enum load_exit {
	LOAD_DONE = 0,
	LOAD_FAILED = 1,     // the daemon refused a request that the load needs
	LOAD_BAD_USAGE = 2,  // wrong options
	LOAD_CONNECTION = 3, // no daemon, or connection lost
} load_exit;

typedef struct load_options {
	const char *url, *scene;
	const char *token_file; // file of the token, or NULL
	// the token, from the environment or from token_file after that is read; or NULL
	const char *token;
	int32_t sessions;
	int32_t viewers; // viewers of each session; viewer 0 drives
	double seconds;  // length of the measurement after the warm-up
	double warm_up_s;
	double slow_pct; // percentage of the viewers that do not drive
	double rate_hz;
	bool json, help, version;
	// if not 0: end the measurement now, report, and remove the sessions
	const volatile sig_atomic_t *interrupted;
} load_options;

// Reads the command line. Prints a mistake on `complaints` and returns false.
bool load_options_read(int argument_count, char **arguments, load_options *options,
                       FILE *complaints);
void load_options_help(FILE *out);
