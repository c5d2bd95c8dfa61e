// SPDX-License-Identifier: GPL-3.0-or-later
// Counts durations in buckets, from any thread and without a lock:
//
//     static cau_histogram steps;
//     cau_histogram_note(&steps, 0.0013);
//     cau_metrics_histogram(out, format, &family, NULL, 0, &(cau_buckets){...});
#pragma once

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

// Upper ends of the buckets, s. They are close together around a tick of 60 Hz (16.7 ms) and around
// the intended duration of a step. A last bucket counts longer durations.
#define CAU_HISTOGRAM_BOUNDS_S                                                                     \
	{                                                                                              \
		0.0001, 0.00025, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.012, 0.0166, 0.025, 0.05, 0.1,      \
			0.25, 0.5, 1, 5                                                                        \
	}
enum { CAU_HISTOGRAM_BOUNDS = 16 };
extern const double cau_histogram_bounds_s[CAU_HISTOGRAM_BOUNDS];

// A histogram; zeroed when nothing has been counted.
typedef struct cau_histogram {
	_Atomic uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1]; // of each bucket alone, not cumulative
	_Atomic uint64_t sum_ns;
} cau_histogram;

// Counts a duration. A negative duration and NaN count as 0.
void cau_histogram_note(cau_histogram *histogram, double seconds);
// Reads the counts of each bucket alone, and the sum in seconds. A duration that is being counted
// may be in the sum and not yet in the counts, or the reverse.
void cau_histogram_read(const cau_histogram *histogram, uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1],
                        double *sum_s);
