// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share.
//
// Locks are taken in this order: the hub's, a session's, the pool's. No other is taken inside the
// clerk's. The functions of cau_elsewhere take a lock of their own; they are called with none held.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "clock/clock.h"
#include "hub/hub.h"
#include "hub/moving.h"
#include "log/log.h"

enum { MOST_SINKS = 4 };

// Sessions that have ended keep their place until they are reaped.
#define SLOTS(config) (2 * (size_t)(config)->max_sessions)

struct cau_hub {
	cau_hub_def def;
	_Atomic int64_t memory_held; // by all sessions, bytes, about
	cau_beginnings beginnings;
	cau_surroundings around;
	cau_surroundings around_ephemeral; // the same with the store in memory
	cau_hosted_times times;
	cau_sink sinks[MOST_SINKS];
	int sink_count;
	cau_elsewhere elsewhere; // asked with no lock of the hub

	pthread_mutex_t mutex; // guards what follows; taken before a session's, never inside one
	cau_hosted **sessions;
	int32_t session_count;
	_Atomic uint32_t last_session;
	_Atomic uint32_t last_resumed; // of those that the daemon begins with, which are the first
	cau_client *clients;
	int32_t client_count, client_capacity;
	uint32_t last_client;

	// the clerk: makes sessions, off the network thread since it reads the store
	cau_task clerk; // see clerk.c
	pthread_mutex_t clerk_mutex;
	cau_creation *first, *last;
	uint32_t last_name;
};

// ---- clerk.c
cau_due cau_clerk_run(cau_task *task);
// Makes and registers a session; takes the creation.
cau_status cau_clerk_make(cau_hub *hub, cau_creation *creation, const char *id, cau_error *error);
void cau_clerk_fork(void *user, cau_hosted *source, int64_t branch, const cau_order *order);

// ---- discard.c
void cau_clerk_answer_missing(cau_hub *hub, const cau_reply *reply, const char *id);
// Destroys the session `asked->name` of the store, which is not among the hub's; answers. One that
// arrives from another daemon is not destroyed.
void cau_clerk_discard(cau_hub *hub, const cau_creation *asked, bool arrives);

// ---- sessions.c
// The definition of a new session from its creation, which keeps scene and meshes. Any thread.
cau_hosted_def cau_hub_define(cau_hub *hub, const cau_creation *creation, const char *id);
// Whether this session is on its way here from another daemon, and is not this daemon's yet.
bool cau_hub_arrives(cau_hub *hub, const char *id);
