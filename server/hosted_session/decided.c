// SPDX-License-Identifier: GPL-3.0-or-later
// What is decided, as any thread may read it: copies, made under the lock.
#include <string.h>

#include "hosted_session/internal.h"

int cau_decided_state(cau_hosted *h)
{
	pthread_mutex_lock(&h->deciding);
	int state = h->logic->state;
	pthread_mutex_unlock(&h->deciding);
	return state;
}

cau_decided cau_decided_now(cau_hosted *h)
{
	pthread_mutex_lock(&h->deciding);
	cau_decided now = {.state = h->logic->state,
	                   .speed = h->logic->speed,
	                   .steps_left = h->logic->steps_left,
	                   .drive_count = h->logic->drive_count};
	memcpy(now.fault, h->logic->fault, sizeof now.fault);
	pthread_mutex_unlock(&h->deciding);
	return now;
}
