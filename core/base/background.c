// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/background.h"

#include <pthread.h>
#include <stdlib.h>

#include "cautery/assert.h"

struct cau_background {
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t changed;
	void (*job)(void *context);
	void *context;
	int stop;
};

static void *run(void *argument)
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
	if (pthread_create(&background->thread, NULL, run, background)) {
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
