// SPDX-License-Identifier: GPL-3.0-or-later
// What scenes with built-in tension came to at rest: snapshots of tick 0, so that a second session
// of a scene begins where the first did, to the bit, and need not settle again. Any of the
// builder's threads may call these.
#pragma once

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/scene.h"

typedef struct cau_session cau_session; // cautery/session.h

enum {
	CAU_BEGINNINGS_MOST = 8,       // scenes
	CAU_BEGINNING_BYTES = 8 << 20, // of a snapshot: some 20,000 vertices; larger ones are not kept
};

typedef struct cau_beginning {
	int holders;      // the list among them
	char *definition; // of the scene as JSON; malloc'ed
	size_t definition_bytes;
	uint64_t tissue_hash; // cau_session_tissue_hash: meshes may have changed since
	void *snapshot;       // malloc'ed
	size_t byte_count;
	uint64_t asked; // when it was asked for last, by the count of all
} cau_beginning;

typedef struct cau_beginnings {
	pthread_mutex_t mutex;                    // guards all, and what holders and asked are of each
	uint64_t asked;                           // how often, of any
	cau_beginning *kept[CAU_BEGINNINGS_MOST]; // or NULL
} cau_beginnings;

void cau_beginnings_init(cau_beginnings *beginnings);
void cau_beginnings_finish(cau_beginnings *beginnings); // nobody holds one

// Of a scene of this definition; NULL: there is none. Whether its meshes are the same is known once
// a session is made of them. Ends with cau_beginnings_let_go.
cau_beginning *cau_beginnings_hold(cau_beginnings *beginnings, const cau_scene_def *scene);
void cau_beginnings_let_go(cau_beginnings *beginnings, cau_beginning *held);
// Keeps that of `core`, which was just made of `scene`, if it had to settle, in place of another of
// this scene or of the one that was asked for longest ago; without memory nothing is kept.
void cau_beginnings_keep(cau_beginnings *beginnings, const cau_scene_def *scene,
                         const cau_session *core);
// Forgets one that is held and did not serve; it is still to be let go.
void cau_beginnings_forget(cau_beginnings *beginnings, const cau_beginning *held);
