// SPDX-License-Identifier: GPL-3.0-or-later
// Counts durations by how long they were, from any thread and without a lock:
//
//     static cau_histogram steps;
//     cau_histogram_note(&steps, 0.0013);
//     cau_metrics_histogram(out, format, &family, NULL, 0, &(cau_buckets){...});
#pragma once

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

// Upper ends of the buckets, s. They stand close around a tick of 60 Hz (16.7 ms) and around what a
// step is to cost; a last bucket takes what is longer.
#define CAU_HISTOGRAM_BOUNDS_S                                                                     \
	{                                                                                              \
		0.0001, 0.00025, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.012, 0.0166, 0.025, 0.05, 0.1,      \
			0.25, 0.5, 1, 5                                                                        \
	}
enum { CAU_HISTOGRAM_BOUNDS = 16 };
extern const double cau_histogram_bounds_s[CAU_HISTOGRAM_BOUNDS];

// All zeros: nothing was noted.
typedef struct cau_histogram {
	_Atomic uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1]; // of each bucket alone
	_Atomic uint64_t sum_ns;
} cau_histogram;

// A duration below 0, or what is no number, counts as 0.
void cau_histogram_note(cau_histogram *histogram, double seconds);
// What was noted so far: the counts of each bucket alone, and the sum in seconds. Notes of the same
// moment may be in one and not yet in the other.
void cau_histogram_read(const cau_histogram *histogram, uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1],
                        double *sum_s);
