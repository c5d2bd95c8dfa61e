// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdint.h>
#include <time.h>

// Returns the seconds of the monotonic clock.
static inline double cau_store_monotonic_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline struct timespec cau_store_timespec(double monotonic_s)
{
	struct timespec time = {.tv_sec = (time_t)monotonic_s};
	time.tv_nsec = (long)((monotonic_s - (double)time.tv_sec) * 1e9);
	return time;
}
