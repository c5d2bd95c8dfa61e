// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/samples.h"

#include <math.h>
#include <stdlib.h>

void load_samples_add(load_samples *samples, double value)
{
	if (samples->count == samples->capacity) {
		size_t capacity = samples->capacity ? 2 * samples->capacity : 4096;
		float *grown =
			capacity <= LOAD_SAMPLES_MAX ? realloc(samples->value, capacity * sizeof *grown) : NULL;
		if (!grown) {
			samples->lost++;
			return;
		}
		samples->value = grown;
		samples->capacity = capacity;
	}
	samples->value[samples->count++] = (float)value;
}

static int ascending(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

double load_samples_percentile(load_samples *samples, double share)
{
	if (!samples->count)
		return NAN;
	qsort(samples->value, samples->count, sizeof *samples->value, ascending);
	size_t rank = (size_t)ceil(share * (double)samples->count);
	return (double)samples->value[rank ? rank - 1 : 0];
}

void load_samples_finish(load_samples *samples)
{
	free(samples->value);
	*samples = (load_samples){0};
}
