// SPDX-License-Identifier: GPL-3.0-or-later
// A thread that runs one job at a time.
#pragma once

typedef struct cau_background cau_background;

cau_background *cau_background_create(void);             // NULL: there is no memory or no thread
void cau_background_destroy(cau_background *background); // waits for the job; accepts NULL

// Starts job(context). The previous job must have been waited for.
void cau_background_start(cau_background *background, void (*job)(void *context), void *context);

// Waits until the job is done; returns at once if there is none. The job's writes are visible
// afterwards.
void cau_background_wait(cau_background *background);
