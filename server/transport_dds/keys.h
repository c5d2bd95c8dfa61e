// SPDX-License-Identifier: GPL-3.0-or-later
// Decides which instances of cautery/tool_command a session's reader accepts. Cyclone keeps an
// instance as long as its writer exists, so a writer with invented keys could fill the memory.
// Beyond a few such keys, samples are dropped and counted before they become instances.
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/command.h"

// Number of accepted keys that name no tool of the session, so that a sender with a wrong name gets
// an error.
enum { CAU_DDS_STRANGERS_MOST = 64 };

typedef struct cau_dds_key {
	char session[CAU_NAME_BYTES], tool[CAU_NAME_BYTES];
} cau_dds_key;

typedef struct cau_dds_keys {
	pthread_mutex_t mutex; // guards the other members: the filter runs on Cyclone's threads
	char session[CAU_NAME_BYTES];
	char tools[CAU_MAX_TOOLS][CAU_NAME_BYTES];
	int tool_count, stranger_count;
	cau_dds_key strangers[CAU_DDS_STRANGERS_MOST];
	uint64_t dropped;
} cau_dds_keys;

void cau_dds_keys_init(cau_dds_keys *keys, const char *session);
void cau_dds_keys_finish(cau_dds_keys *keys);
// Sets the session's tools, at most CAU_MAX_TOOLS.
void cau_dds_keys_set_tools(cau_dds_keys *keys, const char *const *tools, int count);
// True if the reader accepts a sample of this key.
bool cau_dds_keys_admit(cau_dds_keys *keys, const char *session, const char *tool);
// Returns the number of dropped samples since the last call.
uint64_t cau_dds_keys_take_dropped(cau_dds_keys *keys);
