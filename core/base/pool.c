// SPDX-License-Identifier: GPL-3.0-or-later
// Threads: the pool for loops, and the thread that runs one job at a time.
#include "base/pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "cautery/assert.h"

// ---- the pool
// Rounds of waiting before a helper sleeps. Loops follow each other within microseconds during a
// step. So helpers spin for a while before they sleep. Between steps they sleep.
enum { FEW_SPINS = 200, SPINS = 20000, MAX_THREADS = 16 };

// LEAST_ALONE, MOST_ALONE: least and most parts that the caller runs alone after a long wait. CALM:
// parts without a long wait after which the count starts at LEAST_ALONE again. If other programs
// use the machine, a helper may lose its core in the middle of a part. The caller then waits for as
// long as the scheduler decides, hundreds of times a step. So after a long wait the caller runs
// some thousand parts alone, and twice as many each time a long wait follows soon. Parts are
// counted, not loops. A part takes a few microseconds, while a loop takes a hundred times longer in
// a large session than in a small one.
enum { LEAST_ALONE = 1 << 12, MOST_ALONE = 1 << 18, CALM = 1 << 16 }; // all in parts

struct cau_pool {
	int32_t thread_count;
	pthread_t threads[MAX_THREADS];
	void (*part)(void *context, int32_t index);
	void *context;
	// One word holds the loop's generation (32 bits) and the range of unclaimed parts: the first
	// (low 16 bits), and the end (next 16 bits). A claim is one exchange, so a late helper can
	// never take a part of a loop that it did not see. `part` and `context` are read only after a
	// claim, while the loop cannot end. The caller claims from the front and helpers from the back.
	// So in loop after loop the same data are in the same core's cache.
	_Atomic uint64_t ticket;
	_Atomic int32_t parts_left;
	_Atomic int32_t sleepers;
	// Only the caller uses these members. alone: parts that the caller will still run alone.
	// next_alone: value of `alone` after the next long wait. calm: parts since the last long wait.
	int32_t alone, next_alone, calm;
	atomic_bool stop;
	pthread_mutex_t lock;
	pthread_cond_t wake;
};

static void relax(void)
{
#if defined(__x86_64__)
	__builtin_ia32_pause();
#endif
}

static uint32_t generation_of(uint64_t ticket)
{
	return (uint32_t)(ticket >> 32);
}

static void run_parts(cau_pool *pool, int from_front)
{
	uint64_t ticket = atomic_load(&pool->ticket);
	for (;;) {
		int32_t first = ticket & 0xffff, end = (ticket >> 16) & 0xffff;
		CAU_ASSERT(first <= end, "parts %d to %d", first, end);
		if (first >= end)
			return;
		uint64_t claimed = from_front ? ticket + 1 : ticket - (1u << 16);
		if (!atomic_compare_exchange_weak(&pool->ticket, &ticket, claimed))
			continue;
		pool->part(pool->context, from_front ? first : end - 1);
		CAU_ASSERT(atomic_load(&pool->parts_left) > 0, "part %d was done twice", first);
		atomic_fetch_sub(&pool->parts_left, 1);
		ticket = atomic_load(&pool->ticket);
	}
}

static void sleep_until_changed(cau_pool *pool, uint32_t seen)
{
	pthread_mutex_lock(&pool->lock);
	atomic_fetch_add(&pool->sleepers, 1);
	while (generation_of(atomic_load(&pool->ticket)) == seen && !atomic_load(&pool->stop))
		pthread_cond_wait(&pool->wake, &pool->lock);
	atomic_fetch_sub(&pool->sleepers, 1);
	CAU_ASSERT(atomic_load(&pool->sleepers) >= 0, "%d sleepers", atomic_load(&pool->sleepers));
	pthread_mutex_unlock(&pool->lock);
}

static void *helper(void *argument)
{
	cau_pool *pool = argument;
	uint32_t seen = 0;
	pthread_setname_np(pthread_self(), "cautery-step");
	while (!atomic_load(&pool->stop)) {
		int spins = 0;
		while (generation_of(atomic_load(&pool->ticket)) == seen && !atomic_load(&pool->stop)) {
			if (++spins < SPINS)
				relax();
			else
				sleep_until_changed(pool, seen);
		}
		seen = generation_of(atomic_load(&pool->ticket));
		run_parts(pool, 0);
	}
	return NULL;
}

cau_pool *cau_pool_create(int32_t thread_count)
{
	cau_pool *pool = calloc(1, sizeof *pool);
	if (!pool)
		return NULL;
	pthread_mutex_init(&pool->lock, NULL);
	pthread_cond_init(&pool->wake, NULL);
	pool->thread_count = 1;
	pool->next_alone = LEAST_ALONE;
	CAU_ASSERT(thread_count >= 1, "a pool of %d threads", thread_count);
	if (thread_count > MAX_THREADS)
		thread_count = MAX_THREADS;
	while (pool->thread_count < thread_count) {
		if (pthread_create(&pool->threads[pool->thread_count], NULL, helper, pool))
			break;
		pool->thread_count++;
	}
	return pool;
}

void cau_pool_destroy(cau_pool *pool)
{
	if (!pool)
		return;
	pthread_mutex_lock(&pool->lock);
	CAU_ASSERT(!atomic_load(&pool->parts_left), "ended with %d parts to do",
	           atomic_load(&pool->parts_left));
	atomic_store(&pool->stop, 1);
	pthread_cond_broadcast(&pool->wake);
	pthread_mutex_unlock(&pool->lock);
	for (int32_t i = 1; i < pool->thread_count; i++)
		pthread_join(pool->threads[i], NULL);
	pthread_cond_destroy(&pool->wake);
	pthread_mutex_destroy(&pool->lock);
	free(pool);
}

int32_t cau_pool_thread_count(const cau_pool *pool)
{
	return pool->thread_count;
}

// Returns how often this thread lost its core involuntarily.
static long preemptions(void)
{
	struct rusage usage;
	return getrusage(RUSAGE_THREAD, &usage) ? 0 : usage.ru_nivcsw;
}

// Waits for the parts that helpers have claimed. Returns true if another program delayed them.
static bool wait_long(cau_pool *pool)
{
	long before = preemptions();
	int spins = 0;
	for (; atomic_load(&pool->parts_left); spins++) {
		if (spins < SPINS)
			relax();
		else
			sched_yield();
	}
	return spins > SPINS || preemptions() != before;
}

static void wait_for_helpers(cau_pool *pool, int32_t part_count)
{
	CAU_ASSERT(pool->next_alone >= LEAST_ALONE && pool->next_alone <= MOST_ALONE, "%d parts alone",
	           pool->next_alone);
	for (int spins = 0; spins < FEW_SPINS && atomic_load(&pool->parts_left); spins++)
		relax();
	if (atomic_load(&pool->parts_left) && wait_long(pool)) {
		pool->alone = pool->next_alone;
		pool->next_alone = pool->next_alone < MOST_ALONE ? 2 * pool->next_alone : MOST_ALONE;
		pool->calm = 0;
	} else if (pool->calm < CALM) {
		pool->calm += part_count;
		if (pool->calm >= CALM)
			pool->next_alone = LEAST_ALONE;
	}
}

void cau_pool_run(cau_pool *pool, int32_t part_count, void (*part)(void *context, int32_t index),
                  void *context)
{
	CAU_ASSERT(part_count >= 0 && part_count <= CAU_POOL_PARTS, "%d parts", part_count);
	if (pool->thread_count == 1 || part_count <= 1 || pool->alone > 0) {
		for (int32_t i = 0; i < part_count; i++)
			part(context, i);
		pool->alone -= pool->alone > 0 ? part_count : 0;
		return;
	}
	CAU_ASSERT(!atomic_load(&pool->parts_left), "two loops at once, the other with %d parts to do",
	           atomic_load(&pool->parts_left));
	pool->part = part;
	pool->context = context;
	atomic_store(&pool->parts_left, part_count);
	uint64_t generation = generation_of(atomic_load(&pool->ticket)) + 1u;
	atomic_store(&pool->ticket, generation << 32 | (uint64_t)part_count << 16);
	if (atomic_load(&pool->sleepers)) {
		pthread_mutex_lock(&pool->lock);
		pthread_cond_broadcast(&pool->wake);
		pthread_mutex_unlock(&pool->lock);
	}
	run_parts(pool, 1);
	wait_for_helpers(pool, part_count);
}

// ---- a thread in the background
struct cau_background {
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t changed;
	void (*job)(void *context);
	void *context;
	int stop;
};

static void *run_jobs(void *argument)
{
	cau_background *background = argument;
	pthread_setname_np(pthread_self(), "cautery-factor");
	pthread_mutex_lock(&background->lock);
	for (;;) {
		while (!background->job && !background->stop)
			pthread_cond_wait(&background->changed, &background->lock);
		if (!background->job)
			break;
		pthread_mutex_unlock(&background->lock);
		background->job(background->context);
		pthread_mutex_lock(&background->lock);
		background->job = NULL;
		pthread_cond_broadcast(&background->changed);
	}
	pthread_mutex_unlock(&background->lock);
	return NULL;
}

cau_background *cau_background_create(void)
{
	cau_background *background = calloc(1, sizeof *background);
	if (!background)
		return NULL;
	pthread_mutex_init(&background->lock, NULL);
	pthread_cond_init(&background->changed, NULL);
	if (pthread_create(&background->thread, NULL, run_jobs, background)) {
		pthread_cond_destroy(&background->changed);
		pthread_mutex_destroy(&background->lock);
		free(background);
		return NULL;
	}
	return background;
}

void cau_background_destroy(cau_background *background)
{
	if (!background)
		return;
	pthread_mutex_lock(&background->lock);
	CAU_ASSERT(!background->stop, "ended twice");
	background->stop = 1;
	pthread_cond_broadcast(&background->changed);
	pthread_mutex_unlock(&background->lock);
	pthread_join(background->thread, NULL);
	pthread_cond_destroy(&background->changed);
	pthread_mutex_destroy(&background->lock);
	free(background);
}

void cau_background_start(cau_background *background, void (*job)(void *context), void *context)
{
	CAU_ASSERT(job != NULL, "no job to do with %p", context);
	pthread_mutex_lock(&background->lock);
	CAU_ASSERT(!background->job, "the last job with %p has not been waited for",
	           background->context);
	CAU_ASSERT(!background->stop, "a job for a thread that is being ended");
	background->context = context;
	background->job = job;
	pthread_cond_broadcast(&background->changed);
	pthread_mutex_unlock(&background->lock);
}

void cau_background_wait(cau_background *background)
{
	CAU_ASSERT(!pthread_equal(pthread_self(), background->thread), "a job waits for itself");
	pthread_mutex_lock(&background->lock);
	while (background->job)
		pthread_cond_wait(&background->changed, &background->lock);
	pthread_mutex_unlock(&background->lock);
}
