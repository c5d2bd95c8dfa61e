// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/builder.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "clock/clock.h"
#include "worker/pool.h"

// ---- the order of jobs --------------------------------------------------------------------------

void cau_job_queue_put(cau_job_queue *queue, cau_job *job, double now_s)
{
	job->rank = now_s + CAU_JOB_PATIENCE * job->expected_s;
	cau_job **place = &queue->first;
	while (*place && (*place)->rank <= job->rank) // jobs of equal rank stay in order
		place = &(*place)->next;
	job->next = *place;
	*place = job;
	queue->count++;
}

cau_job *cau_job_queue_take(cau_job_queue *queue)
{
	cau_job *job = queue->first;
	if (job) {
		queue->first = job->next;
		job->next = NULL;
		queue->count--;
	}
	return job;
}

// ---- the builder --------------------------------------------------------------------------------

struct cau_builder {
	pthread_mutex_t mutex; // guards all members
	pthread_cond_t work;   // signals that there is a job, or that the builder stops
	const char *name;
	int nice;
	bool stopping;
	cau_job_queue shorts, longs;
	int under_way;
	int32_t thread_count;
	pthread_t thread[1 + CAU_BUILDER_THREADS_MOST]; // the first takes only short jobs
};

static bool is_long(const cau_job *job)
{
	return job->expected_s > CAU_BUILDER_SHORT_S;
}

// Runs the jobs that this thread may take, until the builder stops. The caller holds the mutex.
static void work(cau_builder *builder, bool takes_long)
{
	while (!builder->stopping) {
		cau_job *job = takes_long ? cau_job_queue_take(&builder->longs) : NULL;
		if (!job)
			job = cau_job_queue_take(&builder->shorts);
		if (!job) {
			pthread_cond_wait(&builder->work, &builder->mutex);
			continue;
		}
		builder->under_way++;
		pthread_mutex_unlock(&builder->mutex);
		job->run(job);
		pthread_mutex_lock(&builder->mutex);
		builder->under_way--;
	}
}

static void *live(cau_builder *builder, bool takes_long)
{
	pthread_setname_np(pthread_self(), builder->name);
	cau_thread_set_nice(builder->nice);
	pthread_mutex_lock(&builder->mutex);
	work(builder, takes_long);
	pthread_mutex_unlock(&builder->mutex);
	return NULL;
}

static void *take_shorts(void *builder)
{
	return live(builder, false);
}

static void *take_all(void *builder)
{
	return live(builder, true);
}

static cau_status start_threads(cau_builder *builder, int32_t count, cau_error *error)
{
	for (; builder->thread_count < count; builder->thread_count++) {
		int code = pthread_create(&builder->thread[builder->thread_count], NULL,
		                          builder->thread_count ? take_all : take_shorts, builder);
		if (code)
			return cau_fail(error, CAU_NO_MEMORY, NULL,
			                "cannot start thread %d of %d of %s: %s (its limit: ulimit -u)",
			                builder->thread_count + 1, count, builder->name, strerrordesc_np(code));
	}
	return CAU_OK;
}

cau_status cau_builder_create(cau_builder **made, const char *name, int32_t threads, int nice,
                              cau_error *error)
{
	CAU_ASSERT(threads >= 1 && threads <= CAU_BUILDER_THREADS_MOST, "%d threads", threads);
	*made = NULL;
	cau_builder *builder = calloc(1, sizeof *builder);
	if (!builder)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the builder");
	builder->name = name;
	builder->nice = nice;
	pthread_mutex_init(&builder->mutex, NULL);
	pthread_cond_init(&builder->work, NULL);
	cau_status status = start_threads(builder, 1 + threads, error);
	if (status) {
		cau_builder_stop(builder);
		cau_builder_destroy(builder);
		return status;
	}
	*made = builder;
	return CAU_OK;
}

void cau_builder_submit(cau_builder *builder, cau_job *job)
{
	pthread_mutex_lock(&builder->mutex);
	bool late = builder->stopping;
	if (!late) {
		cau_job_queue_put(is_long(job) ? &builder->longs : &builder->shorts, job,
		                  cau_monotonic_s());
		pthread_cond_broadcast(&builder->work); // wake all: not every thread may take the job
	}
	pthread_mutex_unlock(&builder->mutex);
	if (late)
		job->drop(job);
}

static void drop_all(cau_job_queue *queue)
{
	for (cau_job *job; (job = cau_job_queue_take(queue));)
		job->drop(job);
}

void cau_builder_stop(cau_builder *builder)
{
	pthread_mutex_lock(&builder->mutex);
	builder->stopping = true; // later jobs are dropped instead of queued
	pthread_cond_broadcast(&builder->work);
	pthread_mutex_unlock(&builder->mutex);
	for (int32_t i = 0; i < builder->thread_count; i++)
		pthread_join(builder->thread[i], NULL);
	builder->thread_count = 0;
	drop_all(&builder->shorts);
	drop_all(&builder->longs);
}

bool cau_builder_is_stopping(cau_builder *builder)
{
	pthread_mutex_lock(&builder->mutex);
	bool stopping = builder->stopping;
	pthread_mutex_unlock(&builder->mutex);
	return stopping;
}

void cau_builder_destroy(cau_builder *builder)
{
	if (!builder)
		return;
	pthread_cond_destroy(&builder->work);
	pthread_mutex_destroy(&builder->mutex);
	free(builder);
}

int cau_builder_busy(cau_builder *builder)
{
	pthread_mutex_lock(&builder->mutex);
	int busy = builder->shorts.count + builder->longs.count + builder->under_way;
	pthread_mutex_unlock(&builder->mutex);
	return busy;
}
