// SPDX-License-Identifier: GPL-3.0-or-later
// One job at a time on a thread of its own.
#pragma once

typedef struct cau_background cau_background;

cau_background *cau_background_create(void);             // NULL: no memory or no thread
void cau_background_destroy(cau_background *background); // waits for the job; takes NULL

// Starts job(context); the last one must have been waited for.
void cau_background_start(cau_background *background, void (*job)(void *context), void *context);

// Returns when the job is done; at once if there is none. The job's writes are visible then.
void cau_background_wait(cau_background *background);
