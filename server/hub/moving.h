// SPDX-License-Identifier: GPL-3.0-or-later
// Functions between the hub and the moves of sessions (server/move).
#pragma once

#include "hub/hub.h"

// ---- functions that the hub calls
// Answers about sessions that are not the hub's. Any thread may call them, without a lock of the
// hub.
typedef struct cau_elsewhere {
	void *user;
	// True if session `id` has moved to another daemon; *to is then its target.
	bool (*moved)(void *user, const char *id, cau_moved_to *to);
	// True if session `id` is arriving and is not this daemon's yet.
	bool (*arrives)(void *user, const char *id);
} cau_elsewhere;

// Call this before sessions exist. Without it no session is elsewhere.
void cau_hub_set_elsewhere(cau_hub *hub, const cau_elsewhere *elsewhere);

// ---- sessions of the store

// Reads session `id` of the store as a creation; free it with cau_creation_free.
cau_status cau_hub_read_session(cau_hub *hub, const char *id, cau_creation **creation,
                                cau_error *error);
// Starts session `id` of the store. Answers `reply` with its description; the reply may have no
// receiver.
cau_status cau_hub_resume_one(cau_hub *hub, const char *id, const cau_reply *reply,
                              cau_error *error);
// Builds session `id` in advance. The session then waits, and belongs to the caller, not to the
// hub. `reply` is answered with move_held. Takes the scene and meshes of the creation if the result
// is CAU_OK. Takes no lock of the hub.
cau_status cau_hub_make_incoming(cau_hub *hub, cau_creation *creation, const char *id,
                                 const cau_reply *reply, cau_hosted **hosted, cau_error *error);
// Adds a session that was built in advance to the hub's sessions. Takes the caller's reference.
// Returns false, and takes nothing, if no slot is free.
bool cau_hub_place(cau_hub *hub, cau_hosted *hosted);

// ---- drivers of a session that moves

// Copies the token with which client `number` gets its tools back. Returns false if there is none.
bool cau_hub_resume_token(cau_hub *hub, uint32_t number, char token[CAU_RESUME_BYTES]);
// Registers a lost client that another daemon has reported. The client may return with its token.
// Returns its number; 0: there are too many clients.
uint32_t cau_hub_expect(cau_hub *hub, const cau_client *client);
