// SPDX-License-Identifier: GPL-3.0-or-later
// Declarations that the files of this folder share.
//
// Locks are taken in this order: the hub's, a session's, the pool's. No other lock is taken inside
// the clerk's. The functions of cau_elsewhere take a lock of their own and are called with no lock
// held.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "clock/clock.h"
#include "hub/hub.h"
#include "log/log.h"

enum { MOST_SINKS = 4 };

// Capacity for sessions. Ended sessions keep their slots until they are reaped.
#define SLOTS(config) (2 * (size_t)(config)->max_sessions)

struct cau_hub {
	cau_hub_def def;
	_Atomic int64_t memory_held; // memory that all sessions take together, bytes, estimated
	cau_beginnings beginnings;
	cau_surroundings around;
	cau_surroundings around_ephemeral; // as `around`, with the store in memory
	cau_hosted_times times;
	cau_sink sinks[MOST_SINKS];
	int sink_count;
	cau_elsewhere elsewhere; // called without any lock of the hub

	// guards the members below; taken before a session's lock, never inside one
	pthread_mutex_t mutex;
	cau_hosted **sessions;
	int32_t session_count;
	_Atomic uint32_t last_session;
	// greatest number of the sessions that the daemon starts with; they have the lowest numbers
	_Atomic uint32_t last_resumed;
	cau_client *clients;
	int32_t client_count, client_capacity;
	uint32_t last_client;

	// The clerk creates sessions. It runs on a worker, not on the network thread, because it reads
	// the store.
	cau_task clerk; // see clerk.c
	pthread_mutex_t clerk_mutex;
	cau_creation *first, *last;
	uint32_t last_name;
};

// ---- clerk.c
cau_due cau_clerk_run(cau_task *task);
// Creates and registers a session. Takes the scene and meshes of the creation.
cau_status cau_clerk_make(cau_hub *hub, cau_creation *creation, const char *id, cau_error *error);
void cau_clerk_fork(void *user, cau_hosted *source, int64_t branch, const cau_order *order);

// ---- discard.c
void cau_clerk_answer_missing(cau_hub *hub, const cau_reply *reply, const char *id);
// Destroys the session `asked->name` of the store, which is not among the hub's, and answers. A
// session that arrives from another daemon is not destroyed.
void cau_clerk_discard(cau_hub *hub, const cau_creation *asked, bool arrives);

// ---- sessions.c
// Makes the definition of a new session from its creation, which still owns scene and meshes. Any
// thread may call this.
cau_hosted_def cau_hub_define(cau_hub *hub, const cau_creation *creation, const char *id);
// True if this session is arriving from another daemon and is not this daemon's yet.
bool cau_hub_arrives(cau_hub *hub, const char *id);
