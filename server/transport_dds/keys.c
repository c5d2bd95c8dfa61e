// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/keys.h"

#include <stdio.h>
#include <string.h>

void cau_dds_keys_init(cau_dds_keys *keys, const char *session)
{
	*keys = (cau_dds_keys){.tool_count = 0};
	pthread_mutex_init(&keys->mutex, NULL);
	snprintf(keys->session, sizeof keys->session, "%s", session);
}

void cau_dds_keys_finish(cau_dds_keys *keys)
{
	pthread_mutex_destroy(&keys->mutex);
}

void cau_dds_keys_set_tools(cau_dds_keys *keys, const char *const *tools, int count)
{
	pthread_mutex_lock(&keys->mutex);
	keys->tool_count = count;
	for (int i = 0; i < count; i++)
		snprintf(keys->tools[i], sizeof keys->tools[i], "%s", tools[i]);
	pthread_mutex_unlock(&keys->mutex);
}

static bool is_tool(const cau_dds_keys *keys, const char *session, const char *tool)
{
	if (strcmp(session, keys->session) != 0)
		return false;
	for (int i = 0; i < keys->tool_count; i++)
		if (strcmp(tool, keys->tools[i]) == 0)
			return true;
	return false;
}

// True if this key, which names no tool of the session, is in `strangers`. Adds a new key if there
// is capacity.
static bool is_known_stranger(cau_dds_keys *keys, const char *session, const char *tool)
{
	for (int i = 0; i < keys->stranger_count; i++)
		if (strcmp(keys->strangers[i].session, session) == 0 &&
		    strcmp(keys->strangers[i].tool, tool) == 0)
			return true;
	if (keys->stranger_count == CAU_DDS_STRANGERS_MOST)
		return false;
	cau_dds_key *made = &keys->strangers[keys->stranger_count++];
	snprintf(made->session, sizeof made->session, "%s", session);
	snprintf(made->tool, sizeof made->tool, "%s", tool);
	return true;
}

bool cau_dds_keys_admit(cau_dds_keys *keys, const char *session, const char *tool)
{
	pthread_mutex_lock(&keys->mutex);
	bool admitted = is_tool(keys, session, tool) || is_known_stranger(keys, session, tool);
	keys->dropped += !admitted;
	pthread_mutex_unlock(&keys->mutex);
	return admitted;
}

uint64_t cau_dds_keys_take_dropped(cau_dds_keys *keys)
{
	pthread_mutex_lock(&keys->mutex);
	uint64_t dropped = keys->dropped;
	keys->dropped = 0;
	pthread_mutex_unlock(&keys->mutex);
	return dropped;
}
