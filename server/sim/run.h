// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a session: steps it, submits the script's commands at their ticks, and notes the result.
#pragma once

#include "cautery/session.h"
#include "sim/options.h"

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
