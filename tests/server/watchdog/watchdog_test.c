// SPDX-License-Identifier: GPL-3.0-or-later
#include "watchdog/watchdog.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <time.h>

#include <cmocka.h>

#include "clock/clock.h"

// Largest delay of the watchdog, s, beyond the delay with which a busy machine wakes any thread
// (`lateness`).
#define LATE_S 0.05

// A thread that sleeps again and again, and notes the longest delay of its waking.
typedef struct lateness {
	pthread_t thread;
	pthread_mutex_t mutex;
	double slept_s, worst_s; // slept_s: start of the present sleep; worst_s: the longest delay
	atomic_bool ending;
} lateness;

enum { SLEEP_NS = 1000000 };

static void note(lateness *l)
{
	double now_s = cau_monotonic_s();
	pthread_mutex_lock(&l->mutex);
	l->worst_s = fmax(l->worst_s, now_s - l->slept_s - 1e-9 * SLEEP_NS);
	l->slept_s = now_s;
	pthread_mutex_unlock(&l->mutex);
}

static void *sleep_again(void *user)
{
	lateness *l = user;
	while (!l->ending) {
		nanosleep(&(struct timespec){.tv_nsec = SLEEP_NS}, NULL);
		note(l);
	}
	return NULL;
}

static void begin(lateness *l)
{
	*l = (lateness){.mutex = PTHREAD_MUTEX_INITIALIZER, .slept_s = cau_monotonic_s()};
	assert_int_equal(pthread_create(&l->thread, NULL, sleep_again, l), 0);
}

static double end(lateness *l)
{
	note(l); // the thread may be late at this moment
	l->ending = true;
	pthread_join(l->thread, NULL);
	return l->worst_s;
}

typedef struct looks {
	pthread_mutex_t mutex, hang;
	pthread_cond_t looked;
	int count;
	double expires_s, looked_s; // expires_s: next deadline, INFINITY if there is none
} looks;

static double look(void *user, double now_s)
{
	looks *l = user;
	pthread_mutex_lock(&l->mutex);
	l->count++;
	l->looked_s = now_s;
	double next_s = l->expires_s > now_s ? l->expires_s : INFINITY;
	pthread_cond_signal(&l->looked);
	pthread_mutex_unlock(&l->mutex);
	return next_s;
}

static void await(looks *l, int count)
{
	pthread_mutex_lock(&l->mutex);
	while (l->count < count)
		pthread_cond_wait(&l->looked, &l->mutex);
	pthread_mutex_unlock(&l->mutex);
}

static looks fresh(void)
{
	return (looks){.mutex = PTHREAD_MUTEX_INITIALIZER,
	               .hang = PTHREAD_MUTEX_INITIALIZER,
	               .looked = PTHREAD_COND_INITIALIZER,
	               .expires_s = INFINITY};
}

static void it_looks_when_something_expires(void **state)
{
	(void)state;
	looks l = fresh();
	lateness late;
	cau_watchdog *watchdog;
	begin(&late);
	l.expires_s = cau_monotonic_s() + 0.1;
	assert_int_equal(cau_watchdog_create(&watchdog, look, &l, NULL), CAU_OK);
	await(&l, 2);
	assert_true(l.looked_s >= l.expires_s);
	assert_true(l.looked_s < l.expires_s + LATE_S + end(&late));
	cau_watchdog_destroy(watchdog);
	assert_int_equal(l.count, 2);
}

static void a_wake_makes_it_look_at_once(void **state)
{
	(void)state;
	looks l = fresh();
	lateness late;
	cau_watchdog *watchdog;
	begin(&late);
	assert_int_equal(cau_watchdog_create(&watchdog, look, &l, NULL), CAU_OK);
	await(&l, 1);
	double woken_s = cau_monotonic_s();
	cau_watchdog_wake(watchdog);
	await(&l, 2);
	assert_true(l.looked_s < woken_s + LATE_S + end(&late));
	cau_watchdog_destroy(watchdog);
	cau_watchdog_destroy(NULL);
}

// Looks, then hangs until the test unlocks the mutex.
static double look_and_hang(void *user, double now_s)
{
	looks *l = user;
	double next_s = look(user, now_s);
	pthread_mutex_lock(&l->hang);
	pthread_mutex_unlock(&l->hang);
	return next_s;
}

static void it_moves_unless_it_hangs(void **state)
{
	(void)state;
	looks l = fresh();
	cau_watchdog *watchdog;
	assert_int_equal(cau_watchdog_create(&watchdog, look_and_hang, &l, NULL), CAU_OK);
	await(&l, 1);
	for (int round = 0; round < 3; round++) {
		// cau_watchdog_moves asks the watchdog to look; the watchdog then looks without another
		// wake
		while (!cau_watchdog_moves(watchdog))
			sched_yield();
	}
	pthread_mutex_lock(&l.hang);
	// The watchdog's last check may not have ended yet.
	while (cau_watchdog_moves(watchdog))
		sched_yield();
	for (int asked = 0; asked < 1000; asked++)
		assert_false(cau_watchdog_moves(watchdog));
	pthread_mutex_unlock(&l.hang);
	while (!cau_watchdog_moves(watchdog))
		sched_yield();
	cau_watchdog_destroy(watchdog);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_looks_when_something_expires),
		cmocka_unit_test(it_moves_unless_it_hangs),
		cmocka_unit_test(a_wake_makes_it_look_at_once),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
