// SPDX-License-Identifier: GPL-3.0-or-later
#include "hub/hub.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hub/internal.h"

// ---- sinks
static void notify_all(void *user, cau_audience audience, cau_buffer *text)
{
	cau_hub *hub = user;
	for (int i = 0; i < hub->sink_count; i++)
		hub->sinks[i].notify(hub->sinks[i].user, audience, cau_buffer_share(text));
	cau_buffer_release(text);
}

static void frames_all(void *user)
{
	cau_hub *hub = user;
	for (int i = 0; i < hub->sink_count; i++)
		hub->sinks[i].frames(hub->sinks[i].user);
}

static void sliced_all(void *user, uint32_t session)
{
	cau_hub *hub = user;
	for (int i = 0; i < hub->sink_count; i++)
		if (hub->sinks[i].sliced)
			hub->sinks[i].sliced(hub->sinks[i].user, session);
}

static void armed(void *user)
{
	cau_hub *hub = user;
	hub->def.armed(hub->def.user);
}

void cau_hub_add_sink(cau_hub *hub, const cau_sink *sink)
{
	if (hub->sink_count < MOST_SINKS)
		hub->sinks[hub->sink_count++] = *sink;
}

// ---- creation and end
cau_status cau_hub_create(cau_hub **made, const cau_hub_def *def, cau_error *error)
{
	*made = NULL;
	cau_hub *hub = calloc(1, sizeof *hub);
	if (hub)
		hub->sessions = calloc(SLOTS(def->config), sizeof(cau_hosted *));
	if (!hub || !hub->sessions) {
		free(hub);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the hub");
	}
	hub->def = *def;
	cau_beginnings_init(&hub->beginnings);
	hub->around = (cau_surroundings){.config = def->config,
	                                 .store = def->store,
	                                 .pool = def->pool,
	                                 .builder = def->builder,
	                                 .mover = def->mover ? def->mover : def->builder,
	                                 .memory_held = &hub->memory_held,
	                                 .beginnings = &hub->beginnings,
	                                 .sink = {hub, notify_all, frames_all, sliced_all},
	                                 .times = &hub->times,
	                                 .armed = armed,
	                                 .fork = cau_clerk_fork,
	                                 .user = hub};
	hub->around_ephemeral = hub->around;
	hub->around_ephemeral.store = def->memory;
	hub->around_ephemeral.ephemeral = true;
	pthread_mutex_init(&hub->mutex, NULL);
	pthread_mutex_init(&hub->clerk_mutex, NULL);
	hub->clerk.run = cau_clerk_run;
	cau_worker_pool_add(def->pool, &hub->clerk);
	*made = hub;
	return CAU_OK;
}

void cau_hub_stop(cau_hub *hub)
{
	if (!hub)
		return;
	cau_worker_pool_remove(hub->def.pool, &hub->clerk);
	for (int32_t i = 0; i < hub->session_count; i++)
		cau_hosted_stop(hub->sessions[i]);
	cau_store_flush(hub->def.store); // commits under way still use their sessions
	if (hub->def.memory)
		cau_store_flush(hub->def.memory);
	for (int32_t i = 0; i < hub->session_count; i++)
		cau_hosted_release(hub->sessions[i]);
	hub->session_count = 0;
}

void cau_hub_destroy(cau_hub *hub)
{
	if (!hub)
		return;
	CAU_ASSERT(hub->session_count == 0 && hub->memory_held == 0,
	           "the hub ends with %d sessions and %lld bytes of others", hub->session_count,
	           (long long)hub->memory_held);
	for (cau_creation *next; hub->first; hub->first = next) {
		next = hub->first->next;
		cau_creation_free(hub->first);
	}
	pthread_mutex_destroy(&hub->mutex);
	pthread_mutex_destroy(&hub->clerk_mutex);
	cau_beginnings_finish(&hub->beginnings);
	free(hub->sessions);
	free(hub->clients);
	free(hub);
}

cau_scenes *cau_hub_scenes(const cau_hub *hub)
{
	return hub->def.scenes;
}

// ---- sessions
// Removes one ended session from the list, or returns NULL. The caller stops it outside the lock.
static cau_hosted *take_ended(cau_hub *hub)
{
	cau_hosted *ended = NULL;
	pthread_mutex_lock(&hub->mutex);
	for (int32_t i = 0; i < hub->session_count && !ended; i++)
		if (cau_hosted_ended(hub->sessions[i])) {
			ended = hub->sessions[i];
			hub->sessions[i] = hub->sessions[--hub->session_count];
		}
	pthread_mutex_unlock(&hub->mutex);
	return ended;
}

static uint32_t take_lost_client(cau_hub *hub, double now_s)
{
	uint32_t number = 0;
	pthread_mutex_lock(&hub->mutex);
	for (int32_t i = 0; i < hub->client_count && !number; i++) {
		const cau_client *client = &hub->clients[i];
		if (client->lost && now_s - client->lost_s > hub->def.config->resume_s) {
			number = client->asker.client;
			hub->clients[i] = hub->clients[--hub->client_count];
		}
	}
	pthread_mutex_unlock(&hub->mutex);
	return number;
}

static void forget(void *user, cau_hosted *hosted)
{
	cau_hosted_abandon(hosted, *(uint32_t *)user);
	cau_hosted_forget_client(hosted, *(uint32_t *)user);
}

void cau_hub_reap(cau_hub *hub)
{
	for (cau_hosted *ended; (ended = take_ended(hub));) {
		cau_hosted_stop(ended);
		cau_hosted_release(ended);
	}
	for (uint32_t number; (number = take_lost_client(hub, cau_monotonic_s()));)
		cau_hub_each(hub, forget, &number);
}

typedef struct watch {
	double now_s, look_s;
} watch;

static void watch_one(void *user, cau_hosted *hosted)
{
	watch *w = user;
	w->look_s = fmin(w->look_s, cau_hosted_watch(hosted, w->now_s));
}

double cau_hub_watch(cau_hub *hub, double now_s)
{
	watch w = {now_s, INFINITY};
	cau_hub_each(hub, watch_one, &w);
	return w.look_s;
}

double cau_hub_longest_slice_s(cau_hub *hub)
{
	return cau_worker_pool_longest_s(hub->def.pool);
}

const cau_hosted_times *cau_hub_times(const cau_hub *hub)
{
	return &hub->times;
}

typedef struct store_news {
	bool ephemeral, takes;
	const char *reason;
} store_news;

static void tell_store(void *user, cau_hosted *hosted)
{
	const store_news *news = user;
	if (cau_hosted_is_ephemeral(hosted) != news->ephemeral)
		return;
	cau_hosted_store_takes(hosted, news->takes, news->reason);
	if (news->takes)
		cau_hosted_want_checkpoint(hosted);
}

void cau_hub_store_takes(cau_hub *hub, bool ephemeral, bool takes, const char *reason)
{
	cau_hub_each(hub, tell_store, &(store_news){ephemeral, takes, reason});
}

static void drain_one(void *user, cau_hosted *hosted)
{
	(void)user;
	cau_hosted_drain(hosted);
}

static void note_undrained(void *user, cau_hosted *hosted)
{
	*(int32_t *)user += !cau_hosted_drained(hosted);
}

void cau_hub_stop_time(cau_hub *hub)
{
	cau_hub_each(hub, drain_one, NULL);
}

void cau_hub_drain(cau_hub *hub, double seconds)
{
	double until_s = cau_monotonic_s() + seconds;
	int32_t left = 1;
	cau_hub_each(hub, drain_one, NULL);
	while (left && cau_monotonic_s() < until_s) {
		left = 0;
		cau_hub_each(hub, note_undrained, &left);
		if (left) {
			struct timespec pause = {0, 2000000};
			nanosleep(&pause, NULL);
		}
	}
	if (left)
		cau_log(CAU_LOG_WARNING, NULL, "not_drained", "sessions=%d", left);
	cau_store_flush(hub->def.store);
}
