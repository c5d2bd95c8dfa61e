// SPDX-License-Identifier: GPL-3.0-or-later
// One run of a seed, in a process of its own, so that what a kill leaves in memory goes with it.
#pragma once

#include "simulation/faults.h"
#include "simulation/promises.h"
#include "simulation/workload.h"

typedef struct run_result {
	bool failed;
	char promise[32], text[1024];
	int64_t simulated_ns;
	uint64_t switches, trace;
	promise_counts counts;
	disk_counts disk;
	int requests;
} run_result;

// `own_process`: false in a debugger; the process ends with the run then, if it fails.
void run_seed(uint64_t seed, const workload *work, bool own_process, run_result *result);
