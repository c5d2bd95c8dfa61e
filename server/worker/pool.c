// SPDX-License-Identifier: GPL-3.0-or-later
#include "worker/pool.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

#include "clock/clock.h"

struct cau_worker_pool {
	pthread_mutex_t mutex;
	pthread_cond_t changed;     // signals that tasks or their times changed
	pthread_cond_t left;        // signals that a slice ended
	bool ending, last_was_long; // last_was_long: the last slice that began was of a long task
	double longest_s;           // processor time of the longest slice, without the undivided part
	int32_t nice;
	int32_t workers; // workers: wanted threads; thread_count: threads made so far
	int32_t thread_count, task_count, task_capacity;
	pthread_t *threads;
	cau_task **tasks;
};

// Time, s, for which a short task counts as one that soon needs a worker again, after its last
// slice.
#define LATELY_S 1.0

static bool is_long(const cau_task *task)
{
	return task->next.piece_s > CAU_SLICE_MOST_S;
}

// True if a long task may begin a slice now. If there are short tasks, one worker is kept for them.
// If there is only one worker, short tasks get it after each slice of a long task.
static bool long_may_begin(const cau_worker_pool *pool, double now_s)
{
	int32_t running = 0;
	bool others = false, others_due = false;
	for (int32_t i = 0; i < pool->task_count; i++) {
		const cau_task *task = pool->tasks[i];
		if (is_long(task)) {
			running += task->running;
			continue;
		}
		others_due = others_due || (!task->running && task->next.due_s <= now_s);
		others =
			others || task->running || !isinf(task->next.due_s) || now_s - task->ended_s < LATELY_S;
	}
	if (pool->workers == 1)
		return !pool->last_was_long || !others_due;
	return !others || running < pool->workers - 1;
}

// Returns the due task with the earliest deadline. Returns NULL if no task is due; *wake_s is then
// the time when the next task becomes due.
static cau_task *pick(cau_worker_pool *pool, double now_s, double *wake_s)
{
	cau_task *best = NULL;
	bool long_too = long_may_begin(pool, now_s);
	*wake_s = INFINITY;
	for (int32_t i = 0; i < pool->task_count; i++) {
		cau_task *task = pool->tasks[i];
		if (task->running || task->leaving || (is_long(task) && !long_too))
			continue;
		if (task->next.due_s > now_s)
			*wake_s = fmin(*wake_s, task->next.due_s);
		else if (!best || task->next.deadline_s < best->next.deadline_s)
			best = task;
	}
	return best;
}

static void wait_until(cau_worker_pool *pool, double wake_s)
{
	if (isinf(wake_s)) {
		pthread_cond_wait(&pool->changed, &pool->mutex);
		return;
	}
	struct timespec until = cau_timespec(wake_s);
	pthread_cond_timedwait(&pool->changed, &pool->mutex, &until);
}

static void run_slice(cau_worker_pool *pool, cau_task *task)
{
	task->running = true;
	task->woken = false;
	pool->last_was_long = is_long(task);
	pthread_mutex_unlock(&pool->mutex);
	task->undivided_s = 0;
	double began_s = cau_thread_cpu_s();
	cau_due next = task->run(task);
	double took_s = cau_thread_cpu_s() - began_s - task->undivided_s;
	pthread_mutex_lock(&pool->mutex);
	pool->longest_s = fmax(pool->longest_s, took_s);
	task->running = false;
	task->next = next;
	task->ended_s = cau_monotonic_s();
	// Tasks that became due during a slice of a long task go before it, however late the long task
	// is.
	if (is_long(task))
		task->next.deadline_s = fmax(next.deadline_s, task->ended_s);
	if (task->woken && next.due_s > 0)
		task->next.due_s = 0;
	if (task->woken && isinf(next.deadline_s))
		task->next.deadline_s = cau_monotonic_s();
	pthread_cond_broadcast(&pool->left);
	pthread_cond_signal(&pool->changed); // the task's new time may be the earliest
}

static void *work(void *argument)
{
	cau_worker_pool *pool = argument;
	pthread_setname_np(pthread_self(), "cautery-work");
	// Without the permission the thread stays at the process's priority, which is not an error.
	cau_thread_set_nice(pool->nice);
	pthread_mutex_lock(&pool->mutex);
	while (!pool->ending) {
		double wake_s;
		cau_task *task = pick(pool, cau_monotonic_s(), &wake_s);
		if (task)
			run_slice(pool, task);
		else
			wait_until(pool, wake_s);
	}
	pthread_mutex_unlock(&pool->mutex);
	return NULL;
}

cau_status cau_worker_pool_create(cau_worker_pool **made, int32_t threads, int32_t task_capacity,
                                  int32_t nice, cau_error *error)
{
	*made = NULL;
	cau_worker_pool *pool = calloc(1, sizeof *pool);
	if (!pool)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the worker pool");
	pthread_condattr_t monotonic;
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_mutex_init(&pool->mutex, NULL);
	pthread_cond_init(&pool->changed, &monotonic);
	pthread_cond_init(&pool->left, NULL);
	pthread_condattr_destroy(&monotonic);
	pool->nice = nice;
	pool->workers = threads;
	pool->task_capacity = task_capacity;
	pool->threads = calloc((size_t)threads, sizeof *pool->threads);
	pool->tasks = calloc((size_t)task_capacity, sizeof(cau_task *));
	if (!pool->threads || !pool->tasks)
		goto fail;
	for (; pool->thread_count < threads; pool->thread_count++)
		if (pthread_create(&pool->threads[pool->thread_count], NULL, work, pool))
			goto fail;
	*made = pool;
	return CAU_OK;
fail:
	cau_worker_pool_destroy(pool);
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no %d worker threads", threads);
}

void cau_worker_pool_destroy(cau_worker_pool *pool)
{
	if (!pool)
		return;
	pthread_mutex_lock(&pool->mutex);
	pool->ending = true;
	pthread_cond_broadcast(&pool->changed);
	pthread_mutex_unlock(&pool->mutex);
	for (int32_t i = 0; i < pool->thread_count; i++)
		pthread_join(pool->threads[i], NULL);
	pthread_cond_destroy(&pool->changed);
	pthread_cond_destroy(&pool->left);
	pthread_mutex_destroy(&pool->mutex);
	free(pool->threads);
	free(pool->tasks);
	free(pool);
}

bool cau_worker_pool_add(cau_worker_pool *pool, cau_task *task)
{
	pthread_mutex_lock(&pool->mutex);
	bool fits = pool->task_count < pool->task_capacity;
	if (fits) {
		task->next = (cau_due){0, cau_monotonic_s(), task->next.piece_s};
		task->running = task->woken = task->leaving = false;
		task->ended_s = -INFINITY;
		task->index = pool->task_count;
		pool->tasks[pool->task_count++] = task;
		pthread_cond_signal(&pool->changed);
	}
	pthread_mutex_unlock(&pool->mutex);
	return fits;
}

void cau_worker_pool_remove(cau_worker_pool *pool, cau_task *task)
{
	pthread_mutex_lock(&pool->mutex);
	// A slice of the task may still run; the wait below lasts until it ends.
	task->leaving = true;
	while (task->running)
		pthread_cond_wait(&pool->left, &pool->mutex);
	cau_task *last = pool->tasks[--pool->task_count];
	pool->tasks[task->index] = last;
	last->index = task->index;
	pthread_mutex_unlock(&pool->mutex);
}

void cau_worker_pool_wake(cau_worker_pool *pool, cau_task *task)
{
	pthread_mutex_lock(&pool->mutex);
	task->woken = true;
	if (!task->running && task->next.due_s > 0) {
		double now_s = cau_monotonic_s();
		task->next.due_s = 0;
		task->next.deadline_s = fmin(task->next.deadline_s, now_s);
		pthread_cond_signal(&pool->changed);
	}
	pthread_mutex_unlock(&pool->mutex);
}

double cau_worker_pool_longest_s(cau_worker_pool *pool)
{
	pthread_mutex_lock(&pool->mutex);
	double longest_s = pool->longest_s;
	pthread_mutex_unlock(&pool->mutex);
	return longest_s;
}

int32_t cau_worker_pool_busy(cau_worker_pool *pool)
{
	pthread_mutex_lock(&pool->mutex);
	double now_s = cau_monotonic_s();
	int32_t busy = 0;
	for (int32_t i = 0; i < pool->task_count; i++)
		busy += pool->tasks[i]->running || pool->tasks[i]->next.due_s <= now_s;
	pthread_mutex_unlock(&pool->mutex);
	return busy;
}

void cau_thread_set_nice(int nice)
{
	setpriority(PRIO_PROCESS, (id_t)gettid(), nice);
}
