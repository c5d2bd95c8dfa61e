// SPDX-License-Identifier: GPL-3.0-or-later
// session.frame_at: views of past ticks of one session. One core computes them on the builder. The
// requests of clients wait in a queue.
#pragma once

#include <pthread.h>

#include "hosted_session/past_core.h"

typedef struct cau_past_views {
	cau_job job; // must be the first member
	cau_hosted *hosted;

	pthread_mutex_t lock; // guards the next six members
	cau_order *waiting;
	cau_order *present; // the request that the core serves; NULL: none
	bool busy;          // the builder has the core
	bool given_up;      // the client cancelled the request in `present`
	bool tired;         // the core must be freed
	double idle_since_s;

	cau_past_core core; // only for the builder while `busy`, as is `stage`
	cau_look_stage stage;
} cau_past_views;

void cau_past_views_init(cau_past_views *views, cau_hosted *hosted);
// Drops the requests of a client. Any thread may call this.
void cau_past_views_give_up(cau_past_views *views, uint32_t client);
// Returns the time at which an unused core must be freed; INFINITY: no time is set.
double cau_past_views_due_s(cau_past_views *views);
// Lets the builder free the core if its time has come.
void cau_past_views_tire(cau_past_views *views, double now_s);
