// SPDX-License-Identifier: GPL-3.0-or-later
// Forged snapshots: snapshots of a tiny scene in which everything happens, with numbers changed and
// the hash made right again.
#pragma once

#include "core/session/stage.h"

enum {
	FORGERY_SHOTS = 6,
	FORGERY_BY_POWER = CAU_PARTING_COUNT, // a scene of energy `tissue`
	FORGERY_KINDS,
};

typedef struct forgery {
	cau_scene_def *scene;
	cau_session *session;
	stage_bytes shot[FORGERY_SHOTS]; // what forgeries begin with
	unsigned char *bytes;            // scratch, as long as the longest shot
} forgery;

// `kind`: a CAU_PARTING_*, or FORGERY_BY_POWER.
forgery *forgery_create(int kind);
void forgery_destroy(forgery *f);

// Copies a shot into f->bytes and makes the changes that `data` says, at most one for each nine
// bytes of it; the hash is right. Returns the count of bytes.
size_t forgery_make(forgery *f, const uint8_t *data, size_t count);

// Restores f->bytes. CAU_OK, or CAU_CORRUPT; anything else, and a refusal that changed the session
// or gave no reason, fails the program.
cau_status forgery_restore(forgery *f, size_t count);

// Steps ten ticks of what was restored. A fault ends it: that is an answer too.
void forgery_step(forgery *f);
