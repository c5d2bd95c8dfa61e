// SPDX-License-Identifier: GPL-3.0-or-later
// The server's clocks; the core reads no clock. Deadlines use the monotonic clock.
#pragma once

#include <math.h>
#include <stdint.h>
#include <time.h>

static inline double cau_monotonic_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Returns the processor time of the calling thread, without the time of other threads and programs.
static inline double cau_thread_cpu_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Returns microseconds since 1970, for clients and the store; never used for deadlines.
static inline int64_t cau_wall_us(void)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static inline struct timespec cau_timespec(double seconds)
{
	double whole = floor(seconds);
	return (struct timespec){(time_t)whole, (long)((seconds - whole) * 1e9)};
}
