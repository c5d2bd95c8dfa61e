// SPDX-License-Identifier: GPL-3.0-or-later
// A histogram of times. Each bin is a tenth wider than the previous one, from 1 us to some 100 s.
// Nothing is allocated.
#pragma once

#include <stdint.h>
#include <stdio.h>

enum { ROBOT_BINS = 194 };

typedef struct robot_histogram {
	uint64_t bins[ROBOT_BINS];
	uint64_t count;
	double most_s;
} robot_histogram;

void robot_histogram_add(robot_histogram *histogram, double seconds);
// Returns the time, s, that `share` of the samples do not exceed. It is the upper edge of a bin.
double robot_histogram_quantile(const robot_histogram *histogram, double share);
void robot_histogram_print(const robot_histogram *histogram, const char *name, FILE *out);
