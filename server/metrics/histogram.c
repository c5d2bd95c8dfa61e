// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/histogram.h"

const double cau_histogram_bounds_s[CAU_HISTOGRAM_BOUNDS] = CAU_HISTOGRAM_BOUNDS_S;

void cau_histogram_note(cau_histogram *histogram, double seconds)
{
	double known_s = seconds > 0 ? seconds : 0;
	int bucket = 0;
	while (bucket < CAU_HISTOGRAM_BOUNDS && known_s > cau_histogram_bounds_s[bucket])
		bucket++;
	atomic_fetch_add_explicit(&histogram->sum_ns, (uint64_t)(known_s * 1e9), memory_order_relaxed);
	atomic_fetch_add_explicit(&histogram->counts[bucket], 1, memory_order_relaxed);
}

void cau_histogram_read(const cau_histogram *histogram, uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1],
                        double *sum_s)
{
	for (int i = 0; i <= CAU_HISTOGRAM_BOUNDS; i++)
		counts[i] = atomic_load_explicit(&histogram->counts[i], memory_order_relaxed);
	*sum_s = 1e-9 * (double)atomic_load_explicit(&histogram->sum_ns, memory_order_relaxed);
}
