// SPDX-License-Identifier: GPL-3.0-or-later
// session.frame_at: views of past ticks of one session. One core goes there, on the builder;
// clients wait for it in line.
#pragma once

#include <pthread.h>

#include "hosted_session/past_core.h"

typedef struct cau_past_views {
	cau_job job; // first
	cau_hosted *hosted;

	pthread_mutex_t lock; // guards these
	cau_order *waiting;
	cau_order *present; // what the core is after; NULL: nothing
	bool busy;          // with the builder
	bool given_up;      // the present one
	bool tired;         // the core shall be freed
	double idle_since_s;

	cau_past_core core; // the builder's while busy, like the stage
	cau_look_stage stage;
} cau_past_views;

void cau_past_views_init(cau_past_views *views, cau_hosted *hosted);
// Drops the requests of a client. Any thread.
void cau_past_views_give_up(cau_past_views *views, uint32_t client);
// When a core without requests shall be freed; INFINITY: no time is set.
double cau_past_views_due_s(cau_past_views *views);
// Has the builder free the core, if it is time.
void cau_past_views_tire(cau_past_views *views, double now_s);
