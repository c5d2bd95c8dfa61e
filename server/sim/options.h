// SPDX-License-Identifier: GPL-3.0-or-later
// What cautery-sim was asked to do.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Exit codes, as --help states them.
typedef enum sim_exit {
	SIM_DONE = 0,
	SIM_FAILED = 1,    // the simulation faulted, or a file could not be written
	SIM_BAD_USAGE = 2, // options
	SIM_BAD_INPUT = 3, // scene, mesh or script
	SIM_REFUSED = 4,   // done, but commands of the script were refused at their tick
} sim_exit;

typedef struct sim_options {
	const char *scene;  // a name, a .json file or a mesh file
	const char *scenes; // folder where names are looked up; NULL: installed, else the source's
	const char *script; // NULL: none
	const char *vtu;    // folder; NULL: none
	const char *csv;    // NULL: none
	double unit_m;      // of a mesh file; 0: guessed
	double seconds;     // below 0: to the script's end and one second more
	int32_t threads;
	int32_t vtu_every;   // ticks
	int64_t snapshot_at; // tick; below 0: never
	bool strict;         // refuse a mesh file that needs mending
	bool cut;            // run the scene's own cut in place of a script
	bool print_cut;      // print the scene's cut as a script and end
	bool json;
	bool help, version;
} sim_options;

// Reads the command line. On a mistake, says it on `complaints` and returns false.
bool sim_options_read(int argument_count, char **arguments, sim_options *options, FILE *complaints);

void sim_options_help(FILE *out);
