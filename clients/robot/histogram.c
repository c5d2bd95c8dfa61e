// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/robot.h"

#include <math.h>
#include <string.h>

static const double least_s = 1e-6, widening = 1.1;

void robot_histogram_add(robot_histogram *h, double seconds)
{
	double bin = ceil(log(fmax(seconds, least_s) / least_s) / log(widening));
	h->bins[bin < ROBOT_BINS - 1 ? (size_t)bin : ROBOT_BINS - 1]++;
	h->count++;
	h->most_s = fmax(h->most_s, seconds);
}

double robot_histogram_quantile(const robot_histogram *h, double share)
{
	uint64_t below = 0, wanted = (uint64_t)ceil(share * (double)h->count);
	for (int i = 0; i < ROBOT_BINS; i++) {
		below += h->bins[i];
		if (h->count && below >= wanted)
			return fmin(least_s * pow(widening, i), h->most_s);
	}
	return 0;
}

// Prints one line for each factor of two, from the first with samples to the last.
void robot_histogram_print(const robot_histogram *h, const char *name, FILE *out)
{
	enum { PER_ROW = 7, WIDTH = 50 }; // PER_ROW bins span a factor of 1.1^7 = 1.95
	static const char bar[WIDTH + 1] = "##################################################";
	fprintf(out, "%s: %llu, p50 %.3f ms, p99 %.3f ms, most %.3f ms\n", name,
	        (unsigned long long)h->count, 1e3 * robot_histogram_quantile(h, 0.5),
	        1e3 * robot_histogram_quantile(h, 0.99), 1e3 * h->most_s);
	for (int i = 0; i < ROBOT_BINS; i += PER_ROW) {
		uint64_t row = 0;
		for (int j = i; j < i + PER_ROW && j < ROBOT_BINS; j++)
			row += h->bins[j];
		int last = i + PER_ROW - 1;
		int width = h->count ? (int)((double)row / (double)h->count * WIDTH + 0.5) : 0;
		if (row)
			fprintf(out, "  to %9.3f ms %9llu %.*s\n", 1e3 * least_s * pow(widening, last),
			        (unsigned long long)row, width, bar);
	}
}
