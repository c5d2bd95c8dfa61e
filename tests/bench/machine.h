// SPDX-License-Identifier: GPL-3.0-or-later
// Describes the machine of a measurement and the other load on this machine. Without the
// description, results of two machines, or of a busy and an idle machine, could be compared by
// mistake.
#pragma once

#include <stdio.h>

enum { BENCH_CACHES_MOST = 8 };

// Properties of the first processor, as the kernel reports them. On a virtual machine the host
// decides this.
typedef struct bench_machine {
	char vendor[32];    // "AuthenticAMD"; on ARM the implementer, "0x41"; "" if unknown
	char name[96];      // "AMD EPYC"; on ARM the board; "" if unknown
	int family;         // on ARM the architecture; -1 if unknown
	int model;          // on ARM the part; -1 if unknown
	int stepping;       // on ARM 16 variant + revision; -1 if unknown
	double mhz_most;    // highest clock; 0 if unknown
	double mhz_present; // clock at the time of reading; 0 if unknown
	int cores;          // number of cores that the system uses
	int cache_count;    // 0 if unknown
	struct {
		char name[8]; // "L1d", "L1i", "L2", ...
		double bytes;
	} caches[BENCH_CACHES_MOST];
} bench_machine;

// Reads ROOT/proc and ROOT/sys. ROOT is "" for this machine.
void bench_machine_read(const char *root, bench_machine *machine);

// Processor time of all cores since boot, in kernel ticks, and of this program in seconds.
typedef struct bench_cpu_time {
	double total, busy; // `busy` excludes steal; total 0 means unknown
	double steal;       // time that the host took from this virtual machine; -1 if unknown
	double own_s;
	double load; // mean number of runnable programs in the last minute; -1 if unknown
} bench_cpu_time;
void bench_cpu_time_read(const char *root, bench_cpu_time *time);

// Shares of the time of all cores between two readings, 0 to 1; -1 if unknown.
typedef struct bench_disturbance {
	double load_before; // load of the first reading, not a share
	double others;      // share of other programs on this machine
	double steal;
} bench_disturbance;
bench_disturbance bench_disturbance_between(const bench_cpu_time *before,
                                            const bench_cpu_time *after, double ticks_per_s);

// Writes the member "machine" of a JSON object. Unknown values are null.
void bench_machine_write_json(FILE *out, const bench_machine *machine, const char *instruction_set,
                              const bench_disturbance *disturbance);
// Writes one line for people.
void bench_machine_write(FILE *out, const bench_machine *machine, const char *instruction_set,
                         const bench_disturbance *disturbance);
