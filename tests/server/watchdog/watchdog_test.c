// SPDX-License-Identifier: GPL-3.0-or-later
#include "watchdog/watchdog.h"

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "clock/clock.h"

// Far beyond what a busy machine takes to wake a thread. How late it is on a quiet one, and what
// that means for energy, is measured on the whole daemon.
#define LATE_S 5

typedef struct looks {
	pthread_mutex_t mutex;
	pthread_cond_t looked;
	int count;
	double expires_s, looked_s; // expires_s: INFINITY for nothing to watch
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
	               .looked = PTHREAD_COND_INITIALIZER,
	               .expires_s = INFINITY};
}

static void it_looks_when_something_expires(void **state)
{
	(void)state;
	looks l = fresh();
	cau_watchdog *watchdog;
	l.expires_s = cau_monotonic_s() + 0.1;
	assert_int_equal(cau_watchdog_create(&watchdog, look, &l, NULL), CAU_OK);
	await(&l, 2);
	assert_true(l.looked_s >= l.expires_s);
	assert_true(l.looked_s < l.expires_s + LATE_S);
	cau_watchdog_destroy(watchdog);
	assert_int_equal(l.count, 2);
}

static void a_wake_makes_it_look_at_once(void **state)
{
	(void)state;
	looks l = fresh();
	cau_watchdog *watchdog;
	assert_int_equal(cau_watchdog_create(&watchdog, look, &l, NULL), CAU_OK);
	await(&l, 1);
	double woken_s = cau_monotonic_s();
	cau_watchdog_wake(watchdog);
	await(&l, 2);
	assert_true(l.looked_s < woken_s + LATE_S);
	cau_watchdog_destroy(watchdog);
	cau_watchdog_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_looks_when_something_expires),
		cmocka_unit_test(a_wake_makes_it_look_at_once),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
