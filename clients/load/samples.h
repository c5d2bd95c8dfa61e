// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers measured, and what half and nearly all of them stay below.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { LOAD_SAMPLES_MAX = 1 << 26 }; // 256 MiB; what comes after is counted in `lost`

typedef struct load_samples {
	float *value;
	size_t count, capacity;
	size_t lost;
} load_samples;

void load_samples_add(load_samples *samples, double value);
// Sorts. The least value that `share` (0 to 1) of all do not exceed; NAN where there are none.
double load_samples_percentile(load_samples *samples, double share);
void load_samples_finish(load_samples *samples);
