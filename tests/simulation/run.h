// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of seeds, each in a process of its own, so that what a kill leaves in memory goes with it.
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

enum { RUNS_MOST = 256 }; // at once

typedef struct run_child {
	uint64_t seed;
	int process, from; // from: the pipe that brings its result
	double most_s;     // of real time; then it hangs
} run_child;

double real_s(void);

// Begins a run in a process of its own. Each child is to be given to run_end.
void run_begin(uint64_t seed, const workload *work, run_child *child);
// Waits until one of the children ends, and returns which.
int run_end(const run_child *children, int count, run_result *result);
// Both of them.
void run_seed(uint64_t seed, const workload *work, run_result *result);
// In this process, which ends with the run if it breaks a promise: for a debugger.
void run_here(uint64_t seed, const workload *work);
