// SPDX-License-Identifier: GPL-3.0-or-later
// What the room of moves asks of the hub, and what the hub asks of it.
#pragma once

#include "hub/hub.h"

// ---- what the hub asks
// Sessions that are not the hub's. Asked with no lock of the hub, from any thread.
typedef struct cau_elsewhere {
	void *user;
	// Whether session `id` has moved to another daemon, and where it is.
	bool (*moved)(void *user, const char *id, cau_moved_to *to);
	// Whether session `id` is on its way here, and is not this daemon's yet.
	bool (*arrives)(void *user, const char *id);
} cau_elsewhere;

// Before sessions exist. Without it no session is elsewhere.
void cau_hub_set_elsewhere(cau_hub *hub, const cau_elsewhere *elsewhere);

// ---- sessions of the store

// The creation of session `id` of the store; freed by cau_creation_free.
cau_status cau_hub_read_session(cau_hub *hub, const char *id, cau_creation **creation,
                                cau_error *error);
// Brings session `id` of the store up; answers `reply` (which may have no asker) with its
// description.
cau_status cau_hub_resume_one(cau_hub *hub, const char *id, const cau_reply *reply,
                              cau_error *error);
// Has session `id` built beforehand: it waits, is none of the hub's sessions, and is the caller's.
// `reply` is answered with move_held. Takes the scene and meshes of the creation on CAU_OK. Takes
// no lock of the hub.
cau_status cau_hub_make_incoming(cau_hub *hub, cau_creation *creation, const char *id,
                                 const cau_reply *reply, cau_hosted **hosted, cau_error *error);
// Makes a session that was built beforehand one of the hub's; takes the caller's reference. False:
// no place is free, and nothing is taken.
bool cau_hub_place(cau_hub *hub, cau_hosted *hosted);

// ---- drivers of a session that moves

// The token with which client `number` gets its tools back. False: it has none.
bool cau_hub_resume_token(cau_hub *hub, uint32_t number, char token[CAU_RESUME_BYTES]);
// Registers a lost client that may come back by its token, as another daemon reported it; its
// number. 0: too many clients.
uint32_t cau_hub_expect(cau_hub *hub, const cau_client *client);
