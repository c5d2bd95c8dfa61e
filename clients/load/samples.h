// SPDX-License-Identifier: GPL-3.0-or-later
// A list of measured values and its percentiles.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Largest number of values, in 256 MiB. Further values are only counted in `lost`.
enum { LOAD_SAMPLES_MAX = 1 << 26 };

typedef struct load_samples {
	float *value;
	size_t count, capacity;
	size_t lost;
} load_samples;

void load_samples_add(load_samples *samples, double value);
// Sorts the values. Returns the smallest value that at least `share` (0 to 1) of all values do not
// exceed; NAN without values.
double load_samples_percentile(load_samples *samples, double share);
void load_samples_finish(load_samples *samples);
