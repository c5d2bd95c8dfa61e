// SPDX-License-Identifier: GPL-3.0-or-later
// The list of the hub's sessions.
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

// ---- moves
void cau_hub_set_elsewhere(cau_hub *hub, const cau_elsewhere *elsewhere)
{
	hub->elsewhere = *elsewhere;
}

bool cau_hub_moved(cau_hub *hub, const char *id, cau_moved_to *to)
{
	return hub->elsewhere.moved && hub->elsewhere.moved(hub->elsewhere.user, id, to);
}

bool cau_hub_arrives(cau_hub *hub, const char *id)
{
	return hub->elsewhere.arrives && hub->elsewhere.arrives(hub->elsewhere.user, id);
}

cau_hosted_def cau_hub_define(cau_hub *hub, const cau_creation *creation, const char *id)
{
	return (cau_hosted_def){.id = id,
	                        .number = ++hub->last_session,
	                        .scene = creation->scene,
	                        .meshes = creation->meshes,
	                        .mesh_bytes = creation->mesh_bytes,
	                        .paused = creation->paused,
	                        .origin = creation->origin};
}

cau_status cau_hub_make_incoming(cau_hub *hub, cau_creation *creation, const char *id,
                                 const cau_reply *reply, cau_hosted **hosted, cau_error *error)
{
	cau_hosted_def def = cau_hub_define(hub, creation, id);
	def.incoming = true;
	def.reply = *reply;
	cau_status status = cau_hosted_create(hosted, &hub->around, &def, error);
	if (!status) {
		creation->scene = NULL;
		creation->meshes = NULL;
	}
	return status;
}

bool cau_hub_place(cau_hub *hub, cau_hosted *hosted)
{
	pthread_mutex_lock(&hub->mutex);
	bool free_place = (size_t)hub->session_count < SLOTS(hub->def.config);
	if (free_place)
		hub->sessions[hub->session_count++] = hosted;
	pthread_mutex_unlock(&hub->mutex);
	return free_place;
}

// ---- counts
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

// Notes the speed of a running session. A session that has just begun to run has no realtime factor
// yet, and reports 0.
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
