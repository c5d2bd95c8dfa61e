// SPDX-License-Identifier: GPL-3.0-or-later
// Threads, locks, conditions and clocks of the code under test. The linker replaces the C library's
// functions by these (--wrap), only in this program.
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <time.h>

#include "log/log.h"
#include "simulation/faults.h"
#include "simulation/scheduler.h"
#include "simulation/threads.h"

#define WRAPPED __attribute__((used)) // called by the linker's --wrap

static sim_random system_random;

void sim_threads_begin(uint64_t seed)
{
	system_random = sim_random_of(seed, 2);
}

// ---- threads
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
                          void *argument);
int __wrap_pthread_join(pthread_t thread, void **result);
int __wrap_pthread_setname_np(pthread_t thread, const char *name);
pthread_t __wrap_pthread_self(void);

WRAPPED int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                                  void *(*run)(void *), void *argument)
{
	(void)attributes;
	*thread = (pthread_t)sim_start(run, argument);
	return 0;
}

WRAPPED int __wrap_pthread_join(pthread_t thread, void **result)
{
	void *made = sim_join((uint64_t)thread);
	if (result)
		*result = made;
	return 0;
}

WRAPPED int __wrap_pthread_setname_np(pthread_t thread, const char *name)
{
	sim_set_name((uint64_t)thread, name);
	return 0;
}

WRAPPED pthread_t __wrap_pthread_self(void)
{
	return (pthread_t)sim_self();
}

// ---- locks
// A simulated mutex. It uses the memory of the C library's mutex, whose static initialiser is all
// zeros.
typedef struct sim_mutex {
	// fiber that has locked the mutex; 0 if free. A fiber of a killed machine holds no lock
	uint64_t owner;
} sim_mutex;
_Static_assert(sizeof(sim_mutex) <= sizeof(pthread_mutex_t), "it fits");

int __wrap_pthread_mutex_init(pthread_mutex_t *mutex, const pthread_mutexattr_t *attributes);
int __wrap_pthread_mutex_destroy(pthread_mutex_t *mutex);
int __wrap_pthread_mutex_lock(pthread_mutex_t *mutex);
int __wrap_pthread_mutex_unlock(pthread_mutex_t *mutex);

WRAPPED int __wrap_pthread_mutex_init(pthread_mutex_t *mutex, const pthread_mutexattr_t *attributes)
{
	(void)attributes;
	memset(mutex, 0, sizeof *mutex);
	return 0;
}

WRAPPED int __wrap_pthread_mutex_destroy(pthread_mutex_t *mutex)
{
	const sim_mutex *m = (sim_mutex *)mutex;
	if (m->owner && sim_is_alive(m->owner))
		sim_fail("locks", "a lock is destroyed while it is held");
	return 0;
}

static void take(sim_mutex *m)
{
	uint64_t self = sim_self();
	if (m->owner == self)
		sim_fail("locks", "a thread takes a lock that it holds");
	while (m->owner && sim_is_alive(m->owner))
		sim_wait(m, SIM_NEVER);
	m->owner = self;
}

static void let_go(sim_mutex *m)
{
	if (m->owner != sim_self())
		sim_fail("locks", "a thread gives back a lock that it does not hold");
	m->owner = 0;
	sim_wake_all(m);
}

WRAPPED int __wrap_pthread_mutex_lock(pthread_mutex_t *mutex)
{
	sim_point();
	take((sim_mutex *)mutex);
	return 0;
}

WRAPPED int __wrap_pthread_mutex_unlock(pthread_mutex_t *mutex)
{
	let_go((sim_mutex *)mutex);
	sim_point();
	return 0;
}

// ---- conditions
int __wrap_pthread_cond_init(pthread_cond_t *condition, const pthread_condattr_t *attributes);
int __wrap_pthread_cond_destroy(pthread_cond_t *condition);
int __wrap_pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex);
int __wrap_pthread_cond_timedwait(pthread_cond_t *condition, pthread_mutex_t *mutex,
                                  const struct timespec *until);
int __wrap_pthread_cond_signal(pthread_cond_t *condition);
int __wrap_pthread_cond_broadcast(pthread_cond_t *condition);

WRAPPED int __wrap_pthread_cond_init(pthread_cond_t *condition,
                                     const pthread_condattr_t *attributes)
{
	(void)condition, (void)attributes;
	return 0;
}

WRAPPED int __wrap_pthread_cond_destroy(pthread_cond_t *condition)
{
	(void)condition;
	return 0;
}

// Waits on a condition. POSIX lets a wait end without a reason, and this function does so now and
// then.
static int wait_on(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns)
{
	let_go((sim_mutex *)mutex);
	int64_t early_ns = sim_wakes_early(until_ns);
	bool woken = sim_wait(condition, early_ns) || early_ns < until_ns;
	take((sim_mutex *)mutex);
	return woken ? 0 : ETIMEDOUT;
}

WRAPPED int __wrap_pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex)
{
	return wait_on(condition, mutex, SIM_NEVER);
}

// All timed waits of the daemon use the monotonic clock.
WRAPPED int __wrap_pthread_cond_timedwait(pthread_cond_t *condition, pthread_mutex_t *mutex,
                                          const struct timespec *until)
{
	return wait_on(condition, mutex, until->tv_sec * SIM_SECOND + until->tv_nsec);
}

WRAPPED int __wrap_pthread_cond_signal(pthread_cond_t *condition)
{
	if (!faults_act(FAULT_signal_lost, 8))
		sim_wake_one(condition);
	return 0;
}

WRAPPED int __wrap_pthread_cond_broadcast(pthread_cond_t *condition)
{
	sim_wake_all(condition);
	return 0;
}

// ---- clocks
int __wrap_clock_gettime(clockid_t clock, struct timespec *now);
int __wrap_nanosleep(const struct timespec *wanted, struct timespec *left);
time_t __wrap_time(time_t *now);
int __wrap_sigtimedwait(const sigset_t *signals, siginfo_t *info, const struct timespec *patience);

#define WALL_OFFSET_S 1700000000 // seconds from 1970 to the start of the simulation

WRAPPED int __wrap_clock_gettime(clockid_t clock, struct timespec *now)
{
	int64_t ns = clock == CLOCK_THREAD_CPUTIME_ID || clock == CLOCK_PROCESS_CPUTIME_ID
	                 ? sim_processor_ns()
	                 : sim_now();
	now->tv_sec = ns / SIM_SECOND + (clock == CLOCK_REALTIME ? WALL_OFFSET_S : 0);
	now->tv_nsec = ns % SIM_SECOND;
	return 0;
}

WRAPPED int __wrap_nanosleep(const struct timespec *wanted, struct timespec *left)
{
	(void)left;
	sim_sleep(wanted->tv_sec * SIM_SECOND + wanted->tv_nsec);
	return 0;
}

WRAPPED time_t __wrap_time(time_t *now)
{
	time_t seconds = (time_t)(sim_now() / SIM_SECOND + WALL_OFFSET_S);
	if (now)
		*now = seconds;
	return seconds;
}

// No signal ever comes, because the simulation ends a daemon by a call.
WRAPPED int __wrap_sigtimedwait(const sigset_t *signals, siginfo_t *info,
                                const struct timespec *patience)
{
	(void)signals, (void)info;
	sim_sleep(patience->tv_sec * SIM_SECOND + patience->tv_nsec);
	errno = EAGAIN;
	return -1;
}

// ---- the rest of the system
ssize_t __wrap_getrandom(void *bytes, size_t count, unsigned flags);
int __wrap_setpriority(__priority_which_t which, id_t who, int value);
void __wrap_cau_log(cau_log_level level, const char *session, const char *event, const char *format,
                    ...);

WRAPPED ssize_t __wrap_getrandom(void *bytes, size_t count, unsigned flags)
{
	(void)flags;
	for (size_t i = 0; i < count; i++)
		((unsigned char *)bytes)[i] = (unsigned char)sim_draw(&system_random);
	return (ssize_t)count;
}

WRAPPED int __wrap_setpriority(__priority_which_t which, id_t who, int value)
{
	(void)which, (void)who, (void)value;
	return 0;
}

WRAPPED void __wrap_cau_log(cau_log_level level, const char *session, const char *event,
                            const char *format, ...)
{
	char text[1024];
	va_list arguments;
	(void)level;
	if (!sim_verbose)
		return;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	sim_say("log %s %s %s", session ? session : "-", event, text);
}
