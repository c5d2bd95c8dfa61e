// SPDX-License-Identifier: GPL-3.0-or-later
// The run itself: steps a session, hands it the script's commands at their ticks, and notes what
// happened.
#pragma once

#include "cautery/session.h"
#include "sim/options.h"

typedef struct sim_result {
	uint64_t ticks;
	double time_s; // simulated
	double wall_s; // of the steps alone
	uint64_t hash;
	double energized_s;    // first time that a tool was hot; below 0: never
	double first_part_s;   // first time that an edge had parted; below 0: never
	int32_t commands;      // of the script, submitted
	int32_t refusals;      // commands refused at their tick
	size_t snapshot_bytes; // 0: no snapshot was taken
	bool snapshot_exact;
	double kinetic_j; // at the end
	cau_statistics statistics;
	char instruction_set[16];
} sim_result;

// Runs `scene` with the script `text` (`script_name` for errors) as the options say. Progress and
// refusals go to `notes`, which may be NULL. On CAU_NUMERICAL and CAU_FAULTED *result still tells
// how far it came. *in_input says whether an error lies in scene or script.
cau_status sim_run(const sim_options *options, const cau_scene_def *scene, const char *script_name,
                   const char *text, size_t bytes, FILE *notes, sim_result *result, bool *in_input,
                   cau_error *error);
