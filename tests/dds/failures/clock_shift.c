// SPDX-License-Identifier: GPL-3.0-or-later
// A library to preload into a program. It shifts the program's wall clock, at any moment, by the
// nanoseconds in the first eight bytes of the file CLOCK_SHIFT. So the clock jumps for this process
// alone. The monotonic clock is not changed.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

// LONG_AGO_S is a time in 2001, s. A later time is of the wall clock, an earlier one of the
// monotonic clock, because no machine is up that long.
enum { A_SECOND_NS = 1000000000, LONG_AGO_S = 1000000000 };

static const volatile int64_t *shift;

__attribute__((constructor)) static void open_shift(void)
{
	const char *name = getenv("CLOCK_SHIFT");
	int file = name ? open(name, O_RDONLY | O_CLOEXEC) : -1;
	if (file < 0)
		return;
	void *bytes = mmap(NULL, sizeof *shift, PROT_READ, MAP_SHARED, file, 0);
	shift = bytes == MAP_FAILED ? NULL : bytes;
	close(file);
}

static struct timespec moved(struct timespec time, int64_t by_ns)
{
	int64_t ns = (int64_t)time.tv_sec * A_SECOND_NS + time.tv_nsec + by_ns;
	return (struct timespec){ns / A_SECOND_NS, ns % A_SECOND_NS};
}

int clock_gettime(clockid_t clock, struct timespec *time)
{
	static int (*real)(clockid_t, struct timespec *);
	if (!real)
		*(void **)&real = dlsym(RTLD_NEXT, "clock_gettime");
	int code = real(clock, time);
	if (code == 0 && shift && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
		*time = moved(*time, *shift);
	return code;
}

int gettimeofday(struct timeval *restrict time, void *restrict zone)
{
	struct timespec now;
	(void)zone;
	clock_gettime(CLOCK_REALTIME, &now);
	*time = (struct timeval){now.tv_sec, now.tv_nsec / 1000};
	return 0;
}

time_t time(time_t *kept)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	if (kept)
		*kept = now.tv_sec;
	return now.tv_sec;
}

// The kernel's clock is not shifted, so a deadline on the wall clock is converted to the kernel's
// time.
int pthread_cond_timedwait(pthread_cond_t *restrict condition, pthread_mutex_t *restrict mutex,
                           const struct timespec *restrict until)
{
	static int (*real)(pthread_cond_t *, pthread_mutex_t *, const struct timespec *);
	if (!real)
		*(void **)&real = dlsym(RTLD_NEXT, "pthread_cond_timedwait");
	struct timespec told = shift && until->tv_sec > LONG_AGO_S ? moved(*until, -*shift) : *until;
	return real(condition, mutex, &told);
}
