// SPDX-License-Identifier: GPL-3.0-or-later
// Runs seeds, each in a process of its own, so that memory leaked by a kill is freed with the
// process.
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

enum { RUNS_MOST = 256 }; // largest number of runs at the same time

typedef struct run_child {
	uint64_t seed;
	int process, from; // from: the pipe with the result
	double most_s;     // limit of real time, s; a run that takes longer counts as hanging
} run_child;

double real_s(void);

// Begins a run in a process of its own. Each child must be passed to run_end.
void run_begin(uint64_t seed, const workload *work, run_child *child);
// Waits until one of the children ends, and returns its index.
int run_end(const run_child *children, int count, run_result *result);
// Begins a run and waits for its end.
void run_seed(uint64_t seed, const workload *work, run_result *result);
// Runs in this process, for a debugger. The process ends if the run breaks a promise.
void run_here(uint64_t seed, const workload *work);
