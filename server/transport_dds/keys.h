// SPDX-License-Identifier: GPL-3.0-or-later
// Which instances of cautery/tool_command a session's reader lets in. Cyclone keeps an instance for
// as long as its writer lives, so a writer that makes up keys could fill the memory: beyond a few
// of those its samples are dropped before they become instances, and counted.
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/command.h"

// Keys that are no tool of the session and are let in all the same, so that who mistakes a name is
// told what is wrong with its sample.
enum { CAU_DDS_STRANGERS_MOST = 64 };

typedef struct cau_dds_key {
	char session[CAU_NAME_BYTES], tool[CAU_NAME_BYTES];
} cau_dds_key;

typedef struct cau_dds_keys {
	pthread_mutex_t mutex; // guards the rest: the filter runs on Cyclone's threads
	char session[CAU_NAME_BYTES];
	char tools[CAU_MAX_TOOLS][CAU_NAME_BYTES];
	int tool_count, stranger_count;
	cau_dds_key strangers[CAU_DDS_STRANGERS_MOST];
	uint64_t dropped;
} cau_dds_keys;

void cau_dds_keys_init(cau_dds_keys *keys, const char *session);
void cau_dds_keys_finish(cau_dds_keys *keys);
// The session's tools from now on; at most CAU_MAX_TOOLS.
void cau_dds_keys_set_tools(cau_dds_keys *keys, const char *const *tools, int count);
// Whether a sample of this key is let in.
bool cau_dds_keys_admit(cau_dds_keys *keys, const char *session, const char *tool);
// How many were not, since it was last asked.
uint64_t cau_dds_keys_take_dropped(cau_dds_keys *keys);
