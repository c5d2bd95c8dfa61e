// SPDX-License-Identifier: GPL-3.0-or-later
// Forged snapshots: snapshots of a tiny scene with all mechanisms, in which numbers are changed and
// the hash is made right again.
#pragma once

#include "core/session/stage.h"

enum {
	FORGERY_SHOTS = 6,
	FORGERY_BY_POWER = CAU_PARTING_COUNT, // the scene with energy `tissue`
	FORGERY_KINDS,
};

typedef struct forgery {
	cau_scene_def *scene;
	cau_session *session;
	stage_bytes shot[FORGERY_SHOTS]; // the snapshots that forgeries change
	unsigned char *bytes;            // scratch, as long as the longest snapshot
} forgery;

// `kind`: a CAU_PARTING_*, or FORGERY_BY_POWER.
forgery *forgery_create(int kind);
void forgery_destroy(forgery *f);

// Copies a snapshot into f->bytes and makes the changes in `data`, at most one change for each nine
// bytes of `data`. The hash is right afterwards. Returns the number of bytes.
size_t forgery_make(forgery *f, const uint8_t *data, size_t count);

// Restores f->bytes. Returns CAU_OK or CAU_CORRUPT. Any other status fails the program. So does a
// refusal that changed the session or gave no reason.
cau_status forgery_restore(forgery *f, size_t count);

// Steps the restored session for ten ticks. A fault ends the steps and is accepted.
void forgery_step(forgery *f);
