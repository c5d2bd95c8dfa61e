// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/builder.h"

#include <pthread.h>
#include <stdlib.h>

#include "builder/job_queue.h"
#include "clock/clock.h"
#include "worker/priority.h"

enum { LANES = 2 }; // short jobs, long jobs

typedef struct lane {
	cau_builder *builder;
	pthread_t thread;
	bool made, busy;
	cau_job_queue queue;
	pthread_cond_t work;
} lane;

struct cau_builder {
	pthread_mutex_t mutex; // guards all
	int nice;
	bool stopping;
	lane lanes[LANES];
};

static void *work(void *argument)
{
	lane *own = argument;
	cau_builder *builder = own->builder;
	pthread_setname_np(pthread_self(), "cautery-build");
	cau_thread_set_nice(builder->nice);
	pthread_mutex_lock(&builder->mutex);
	while (!builder->stopping) {
		cau_job *job = cau_job_queue_take(&own->queue);
		if (!job) {
			pthread_cond_wait(&own->work, &builder->mutex);
			continue;
		}
		own->busy = true;
		pthread_mutex_unlock(&builder->mutex);
		job->run(job);
		pthread_mutex_lock(&builder->mutex);
		own->busy = false;
	}
	pthread_mutex_unlock(&builder->mutex);
	return NULL;
}

cau_status cau_builder_create(cau_builder **made, int nice, cau_error *error)
{
	*made = NULL;
	cau_builder *builder = calloc(1, sizeof *builder);
	if (!builder)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the builder");
	builder->nice = nice;
	pthread_mutex_init(&builder->mutex, NULL);
	for (int i = 0; i < LANES; i++) {
		builder->lanes[i].builder = builder;
		pthread_cond_init(&builder->lanes[i].work, NULL);
	}
	for (int i = 0; i < LANES; i++) {
		lane *own = &builder->lanes[i];
		own->made = pthread_create(&own->thread, NULL, work, own) == 0;
		if (!own->made) {
			cau_builder_stop(builder);
			cau_builder_destroy(builder);
			return cau_fail(error, CAU_NO_MEMORY, NULL, "no thread for the builder");
		}
	}
	*made = builder;
	return CAU_OK;
}

void cau_builder_submit(cau_builder *builder, cau_job *job)
{
	pthread_mutex_lock(&builder->mutex);
	bool late = builder->stopping;
	lane *its = &builder->lanes[job->expected_s > CAU_BUILDER_SHORT_S];
	if (!late) {
		cau_job_queue_put(&its->queue, job, cau_monotonic_s());
		pthread_cond_signal(&its->work);
	}
	pthread_mutex_unlock(&builder->mutex);
	if (late)
		job->drop(job);
}

static void drop_all(cau_builder *builder)
{
	for (int i = 0; i < LANES; i++)
		for (cau_job *job; (job = cau_job_queue_take(&builder->lanes[i].queue));)
			job->drop(job);
}

void cau_builder_stop(cau_builder *builder)
{
	pthread_mutex_lock(&builder->mutex);
	builder->stopping = true; // nothing is queued from here on
	for (int i = 0; i < LANES; i++)
		pthread_cond_signal(&builder->lanes[i].work);
	pthread_mutex_unlock(&builder->mutex);
	for (int i = 0; i < LANES; i++) {
		if (builder->lanes[i].made)
			pthread_join(builder->lanes[i].thread, NULL);
		builder->lanes[i].made = false;
	}
	drop_all(builder);
}

void cau_builder_destroy(cau_builder *builder)
{
	if (!builder)
		return;
	for (int i = 0; i < LANES; i++)
		pthread_cond_destroy(&builder->lanes[i].work);
	pthread_mutex_destroy(&builder->mutex);
	free(builder);
}

int cau_builder_busy(cau_builder *builder)
{
	int busy = 0;
	pthread_mutex_lock(&builder->mutex);
	for (int i = 0; i < LANES; i++)
		busy += builder->lanes[i].queue.count + builder->lanes[i].busy;
	pthread_mutex_unlock(&builder->mutex);
	return busy;
}
