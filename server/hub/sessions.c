// SPDX-License-Identifier: GPL-3.0-or-later
// The list of sessions.
#include <math.h>
#include <string.h>

#include "hub/internal.h"

cau_hosted *cau_hub_find(cau_hub *hub, const char *id)
{
	cau_hosted *found = NULL;
	pthread_mutex_lock(&hub->mutex);
	for (int32_t i = 0; i < hub->session_count && !found; i++)
		if (strcmp(cau_hosted_id(hub->sessions[i]), id) == 0 && !cau_hosted_ended(hub->sessions[i]))
			found = cau_hosted_share(hub->sessions[i]);
	pthread_mutex_unlock(&hub->mutex);
	return found;
}

cau_hosted *cau_hub_find_number(cau_hub *hub, uint32_t number)
{
	cau_hosted *found = NULL;
	pthread_mutex_lock(&hub->mutex);
	for (int32_t i = 0; i < hub->session_count && !found; i++)
		if (cau_hosted_number(hub->sessions[i]) == number && !cau_hosted_ended(hub->sessions[i]))
			found = cau_hosted_share(hub->sessions[i]);
	pthread_mutex_unlock(&hub->mutex);
	return found;
}

void cau_hub_each(cau_hub *hub, void (*visit)(void *user, cau_hosted *hosted), void *user)
{
	pthread_mutex_lock(&hub->mutex);
	for (int32_t i = 0; i < hub->session_count; i++)
		if (!cau_hosted_ended(hub->sessions[i]))
			visit(user, hub->sessions[i]);
	pthread_mutex_unlock(&hub->mutex);
}

static void count_one(void *user, cau_hosted *hosted)
{
	(void)hosted;
	++*(int32_t *)user;
}

int32_t cau_hub_count(cau_hub *hub)
{
	int32_t count = 0;
	cau_hub_each(hub, count_one, &count);
	return count;
}

int64_t cau_hub_memory(cau_hub *hub)
{
	return hub->memory_held;
}

// A session that has just begun to run has no factor yet, and tells 0.
static void note_pace(void *user, cau_hosted *hosted)
{
	double *least = user;
	cau_wire_session_summary summary;
	cau_hosted_summary(hosted, &summary);
	if (summary.state == CAU_SESSION_RUNNING && summary.realtime_factor > 0 && summary.speed > 0)
		*least = fmin(*least, summary.realtime_factor / summary.speed);
}

double cau_hub_pace_share_min(cau_hub *hub)
{
	double least = 1;
	cau_hub_each(hub, note_pace, &least);
	return least;
}
