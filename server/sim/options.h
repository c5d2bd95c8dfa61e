// SPDX-License-Identifier: GPL-3.0-or-later
// The command line of cautery-sim.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Exit codes, as --help lists them.
typedef enum sim_exit {
	SIM_DONE = 0,
	SIM_FAILED = 1,    // the simulation faulted, or a file could not be written
	SIM_BAD_USAGE = 2, // wrong options
	SIM_BAD_INPUT = 3, // wrong scene, mesh or script
	SIM_REFUSED = 4,   // the run is complete, but commands of the script were refused at their tick
} sim_exit;

typedef struct sim_options {
	const char *scene;  // a name, a .json file or a mesh file
	const char *scenes; // folder of named scenes; NULL: the installed ones, else the source tree's
	const char *script; // NULL: no script
	const char *vtu;    // folder of VTU files; NULL: no such files
	const char *csv;    // file for comma-separated values; NULL: no such file
	double unit_m;      // length of a mesh file's unit, m; 0: guessed
	double seconds;     // below 0: until one second after the script's end
	int32_t threads;
	int32_t vtu_every;   // ticks between VTU files
	int64_t snapshot_at; // tick of the snapshot; below 0: no snapshot
	bool strict;         // refuse a mesh file that needs mending
	bool cut;            // run the scene's own cut in place of a script
	bool print_cut;      // print the scene's cut as a script and end
	bool json;
	bool help, version;
} sim_options;

// Reads the command line. On a mistake, reports it on `complaints` and returns false.
bool sim_options_read(int argument_count, char **arguments, sim_options *options, FILE *complaints);

void sim_options_help(FILE *out);
