// SPDX-License-Identifier: GPL-3.0-or-later
// On which machine a run was measured, and what else that machine did meanwhile: figures of two
// machines, or of a busy and an idle one, are not to be compared by mistake.
#pragma once

#include <stdio.h>

enum { BENCH_CACHES_MOST = 8 };

// What the kernel says of the first processor; on a virtual machine that is what its host lets it
// say.
typedef struct bench_machine {
	char vendor[32];    // "AuthenticAMD"; on ARM the implementer, "0x41"; "": unknown
	char name[96];      // "AMD EPYC"; on ARM the board if it is told; "": unknown
	int family;         // on ARM the architecture; -1: unknown, as in the next two
	int model;          // on ARM the part
	int stepping;       // on ARM 16 variant + revision
	double mhz_most;    // highest clock; 0: unknown
	double mhz_present; // clock when it was read; 0: unknown
	int cores;          // that the system runs on
	int cache_count;    // 0: unknown
	struct {
		char name[8]; // "L1d", "L1i", "L2", ...
		double bytes;
	} caches[BENCH_CACHES_MOST];
} bench_machine;

// Reads ROOT/proc and ROOT/sys; ROOT is "" for the machine itself.
void bench_machine_read(const char *root, bench_machine *machine);

// Processor time of all cores since boot, in the kernel's ticks, and this program's own.
typedef struct bench_cpu_time {
	double total, busy; // `busy` holds no steal; total 0: unknown
	double steal;       // taken by the host from a virtual machine; -1: unknown
	double own_s;
	double load; // mean number of programs that wanted to run in the last minute; -1: unknown
} bench_cpu_time;
void bench_cpu_time_read(const char *root, bench_cpu_time *time);

// Shares of all cores' time between two readings, 0 to 1; -1: unknown.
typedef struct bench_disturbance {
	double load_before; // of the first reading; no share
	double others;      // that other programs of this machine used
	double steal;
} bench_disturbance;
bench_disturbance bench_disturbance_between(const bench_cpu_time *before,
                                            const bench_cpu_time *after, double ticks_per_s);

// As the member "machine" of a JSON object; what is unknown is null.
void bench_machine_write_json(FILE *out, const bench_machine *machine, const char *instruction_set,
                              const bench_disturbance *disturbance);
// As one line for people.
void bench_machine_write(FILE *out, const bench_machine *machine, const char *instruction_set,
                         const bench_disturbance *disturbance);
