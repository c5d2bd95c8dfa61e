// SPDX-License-Identifier: GPL-3.0-or-later
// Caches the rest state of scenes with built-in tension, as snapshots of tick 0. A second session
// of the same scene starts from the same bits as the first and need not settle again. Any thread of
// the builder may call these functions.
#pragma once

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/scene.h"

typedef struct cau_session cau_session; // cautery/session.h

enum {
	CAU_BEGINNINGS_MOST = 8, // most scenes in the cache
	// largest snapshot in the cache, about 20,000 vertices; larger snapshots are not cached
	CAU_BEGINNING_BYTES = 8 << 20,
};

typedef struct cau_beginning {
	int holders;      // number of references, including the cache's own
	char *definition; // the scene's definition as JSON; malloc'ed
	size_t definition_bytes;
	uint64_t tissue_hash; // from cau_session_tissue_hash: detects mesh files that changed since
	void *snapshot;       // malloc'ed
	size_t byte_count;
	uint64_t asked; // value of cau_beginnings.asked at the latest request
} cau_beginning;

typedef struct cau_beginnings {
	pthread_mutex_t mutex; // guards this struct, and `holders` and `asked` of each entry
	uint64_t asked;        // number of requests for any entry
	cau_beginning *kept[CAU_BEGINNINGS_MOST]; // NULL: an unused slot
} cau_beginnings;

void cau_beginnings_init(cau_beginnings *beginnings);
void cau_beginnings_finish(cau_beginnings *beginnings); // no caller may still hold an entry

// Returns an entry for a scene with this definition, or NULL. The caller can check whether the
// meshes are the same once a session is built. Release the entry with cau_beginnings_let_go.
cau_beginning *cau_beginnings_hold(cau_beginnings *beginnings, const cau_scene_def *scene);
void cau_beginnings_let_go(cau_beginnings *beginnings, cau_beginning *held);
// Caches the rest state of `core`, which was just built from `scene`, if the core had to settle.
// Replaces the entry of this scene, or else the entry with the oldest request. Caches nothing if
// memory runs out.
void cau_beginnings_keep(cau_beginnings *beginnings, const cau_scene_def *scene,
                         const cau_session *core);
// Removes an entry from the cache because its state did not fit a core. The caller still holds the
// entry and must call cau_beginnings_let_go.
void cau_beginnings_forget(cau_beginnings *beginnings, const cau_beginning *held);
