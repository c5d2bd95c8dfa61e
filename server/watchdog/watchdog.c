// SPDX-License-Identifier: GPL-3.0-or-later
#include "watchdog/watchdog.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "clock/clock.h"
#include "worker/pool.h"

struct cau_watchdog {
	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	bool started, woken, ending;
	bool asked_to_move; // cau_watchdog_moves() was called, and the watchdog has not looked since
	double (*look)(void *user, double now_s);
	void *user;
};

static void wait_until(cau_watchdog *w, double look_s)
{
	struct timespec until = cau_timespec(isinf(look_s) ? 0 : look_s);
	while (!w->woken && !w->ending) {
		if (isinf(look_s))
			pthread_cond_wait(&w->changed, &w->mutex);
		else if (pthread_cond_timedwait(&w->changed, &w->mutex, &until))
			break;
	}
	w->woken = false;
}

static void *watch(void *argument)
{
	cau_watchdog *w = argument;
	pthread_setname_np(pthread_self(), "cautery-watch");
	cau_thread_set_nice(CAU_NICE_FIRST);
	pthread_mutex_lock(&w->mutex);
	while (!w->ending) {
		pthread_mutex_unlock(&w->mutex);
		double look_s = w->look(w->user, cau_monotonic_s());
		pthread_mutex_lock(&w->mutex);
		// If cau_watchdog_moves() was called during the look, the watchdog looks again.
		w->asked_to_move = w->asked_to_move && w->woken;
		wait_until(w, look_s);
	}
	pthread_mutex_unlock(&w->mutex);
	return NULL;
}

cau_status cau_watchdog_create(cau_watchdog **made, double (*look)(void *user, double now_s),
                               void *user, cau_error *error)
{
	*made = NULL;
	cau_watchdog *w = calloc(1, sizeof *w);
	if (!w)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the watchdog");
	pthread_condattr_t monotonic;
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_mutex_init(&w->mutex, NULL);
	pthread_cond_init(&w->changed, &monotonic);
	pthread_condattr_destroy(&monotonic);
	w->look = look;
	w->user = user;
	int code = pthread_create(&w->thread, NULL, watch, w);
	w->started = code == 0;
	if (code) {
		cau_watchdog_destroy(w);
		return cau_fail(error, CAU_NO_MEMORY, NULL,
		                "cannot start the watchdog's thread: %s (its limit: ulimit -u)",
		                strerrordesc_np(code));
	}
	*made = w;
	return CAU_OK;
}

void cau_watchdog_destroy(cau_watchdog *w)
{
	if (!w)
		return;
	pthread_mutex_lock(&w->mutex);
	w->ending = true;
	pthread_cond_broadcast(&w->changed);
	pthread_mutex_unlock(&w->mutex);
	if (w->started)
		pthread_join(w->thread, NULL);
	pthread_cond_destroy(&w->changed);
	pthread_mutex_destroy(&w->mutex);
	free(w);
}

void cau_watchdog_wake(cau_watchdog *w)
{
	pthread_mutex_lock(&w->mutex);
	w->woken = true;
	pthread_cond_signal(&w->changed);
	pthread_mutex_unlock(&w->mutex);
}

bool cau_watchdog_moves(cau_watchdog *w)
{
	pthread_mutex_lock(&w->mutex);
	bool moved = !w->asked_to_move;
	w->asked_to_move = w->woken = true;
	pthread_cond_signal(&w->changed);
	pthread_mutex_unlock(&w->mutex);
	return moved;
}
