// SPDX-License-Identifier: GPL-3.0-or-later
// The server's clocks. The core has none; deadlines are on the monotonic one.
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

// Processor time of the calling thread: what others take of the machine is not in it.
static inline double cau_thread_cpu_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Microseconds since 1970: for clients and the store, never for deadlines.
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
