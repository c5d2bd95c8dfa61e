// SPDX-License-Identifier: GPL-3.0-or-later
// Times in bins that widen by a tenth each, from 1 us to some 100 s; no allocation.
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
// The time, s, that `share` of the samples do not exceed: the upper edge of its bin.
double robot_histogram_quantile(const robot_histogram *histogram, double share);
void robot_histogram_print(const robot_histogram *histogram, const char *name, FILE *out);
