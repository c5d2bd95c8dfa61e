// SPDX-License-Identifier: GPL-3.0-or-later
// What cautery-load was asked to do.
#pragma once

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Exit codes, as --help states them.
typedef enum load_exit {
	LOAD_DONE = 0,
	LOAD_FAILED = 1,     // the daemon refused something that the load needs
	LOAD_BAD_USAGE = 2,  // options
	LOAD_CONNECTION = 3, // no daemon, or lost
} load_exit;

typedef struct load_options {
	const char *url, *scene;
	const char *token_file; // or NULL: `token`
	const char *token;      // from the environment or, once it is read, from the file; or NULL
	int32_t sessions;
	int32_t viewers; // of each session; the first one drives
	double seconds;  // measured, after the warm-up
	double warm_up_s;
	double slow_pct; // of the viewers that do not drive
	double rate_hz;
	bool json, help, version;
	const volatile sig_atomic_t
		*interrupted; // not 0: end the window now, report, remove the sessions
} load_options;

// On a mistake, says it on `complaints` and returns false.
bool load_options_read(int argument_count, char **arguments, load_options *options,
                       FILE *complaints);
void load_options_help(FILE *out);
