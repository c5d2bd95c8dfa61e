// SPDX-License-Identifier: GPL-3.0-or-later
// What scenes with built-in tension came to at rest: snapshots of tick 0, so that a second session
// of a scene begins where the first did, to the bit, and need not settle again. The builder's alone.
#pragma once

#include <stddef.h>

#include "cautery/scene.h"
#include "cautery/session.h"

enum {
	CAU_BEGINNINGS_MOST = 8,            // scenes
	CAU_BEGINNINGS_BYTES = 64 << 20,    // of all their snapshots
};

typedef struct cau_beginning {
	cau_scene_def *scene; // malloc'ed
	void *snapshot;       // malloc'ed
	size_t byte_count;
} cau_beginning;

// Zeroed: none.
typedef struct cau_beginnings {
	int32_t count;
	size_t byte_count;                        // of all snapshots
	cau_beginning kept[CAU_BEGINNINGS_MOST]; // the one that was asked for last comes first
} cau_beginnings;

// Of this very scene; NULL: there is none. Borrowed until the next call. That the meshes of files
// are what they were is seen when it is restored: the core knows the tissue that a snapshot is of.
const cau_beginning *cau_beginnings_find(cau_beginnings *beginnings, const cau_scene_def *scene);
// Keeps that of `core`, which was just made of `scene`, if it had to settle. Those that were asked
// for longest ago give way; without memory nothing is kept.
void cau_beginnings_keep(cau_beginnings *beginnings, const cau_scene_def *scene,
                         const cau_session *core);
// Forgets the first, which was found and did not serve.
void cau_beginnings_drop_first(cau_beginnings *beginnings);
void cau_beginnings_finish(cau_beginnings *beginnings);
