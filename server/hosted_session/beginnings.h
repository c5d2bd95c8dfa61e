// SPDX-License-Identifier: GPL-3.0-or-later
// What scenes with built-in tension came to at rest: snapshots of tick 0, so that a second session
// of a scene begins where the first did, to the bit, and need not settle again. The builder's
// alone.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "cautery/scene.h"

typedef struct cau_session cau_session; // cautery/session.h

enum {
	CAU_BEGINNINGS_MOST = 8,       // scenes
	CAU_BEGINNING_BYTES = 8 << 20, // of a snapshot: some 20,000 vertices; larger ones are not kept
};

typedef struct cau_beginning {
	char *definition; // of the scene as JSON; malloc'ed; NULL: the place is empty
	size_t definition_bytes;
	uint64_t tissue_hash; // cau_session_tissue_hash: meshes may have changed since
	void *snapshot;       // malloc'ed
	size_t byte_count;
	uint64_t asked; // when it was asked for last, by the count of all
} cau_beginning;

// Zeroed: none.
typedef struct cau_beginnings {
	uint64_t asked; // how often, of any
	cau_beginning kept[CAU_BEGINNINGS_MOST];
} cau_beginnings;

// Of a scene of this definition; NULL: there is none. Borrowed until the next call. Whether its
// meshes are the same is known once a session is made of them.
cau_beginning *cau_beginnings_find(cau_beginnings *beginnings, const cau_scene_def *scene);
// Keeps that of `core`, which was just made of `scene`, if it had to settle. The one that was asked
// for longest ago gives way; without memory nothing is kept.
void cau_beginnings_keep(cau_beginnings *beginnings, const cau_scene_def *scene,
                         const cau_session *core);
// Forgets one that was found and did not serve.
void cau_beginning_drop(cau_beginning *found);
void cau_beginnings_finish(cau_beginnings *beginnings);
