// SPDX-License-Identifier: GPL-3.0-or-later
// A run of cautery-sim: its options, its result and its reports.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "cautery/scene.h"
#include "cautery/session.h"
#include "cautery/status.h"

// ---- the command line
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

// ---- running
// Steps a session, submits the script's commands at their ticks, and notes the result.

typedef struct sim_result {
	uint64_t ticks;
	double time_s; // simulated time
	double wall_s; // wall time of the steps alone
	uint64_t hash;
	double energized_s;    // first time that energy was on; below 0: never
	double first_part_s;   // first time that an edge had parted; below 0: never
	int32_t commands;      // commands of the script that were submitted
	int32_t refusals;      // commands refused at their tick
	size_t snapshot_bytes; // 0 if no snapshot was taken
	bool snapshot_exact;
	double kinetic_j; // kinetic energy at the end
	cau_statistics statistics;
	char instruction_set[16];
} sim_result;

// Runs `scene` with the script `text` as the options say; `script_name` is for errors. Progress and
// refusals go to `notes`, which may be NULL. After CAU_NUMERICAL and CAU_FAULTED, *result has the
// values up to the failure. *in_input says whether an error is in the scene or the script.
cau_status sim_run(const sim_options *options, const cau_scene_def *scene, const char *script_name,
                   const char *text, size_t bytes, FILE *notes, sim_result *result, bool *in_input,
                   cau_error *error);

// ---- reports at the end
void sim_report_text(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result);

// Writes the result as one line of JSON. `error` is the failure that ended the run, or NULL.
void sim_report_json(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result, const cau_error *error);

// Writes one line of JSON for a run that never began.
void sim_report_json_error(FILE *out, const cau_error *error);

// Writes "file: path: reason", as far as they are known.
void sim_report_error(FILE *out, const cau_error *error);
