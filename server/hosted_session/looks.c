// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/looks.h"

#include <math.h>
#include <stdlib.h>

#include "cautery/assert.h"

#define KEPT_S 60.0 // an idle core goes after this: it takes as much memory as the session's own

// Out of the line, or NULL. Under the mutex.
static cau_order *take_of_client(cau_looks *looks, uint32_t client)
{
	cau_order **place = &looks->waiting;
	while (*place && (*place)->asker.client != client)
		place = &(*place)->next;
	cau_order *order = *place;
	if (order)
		*place = order->next;
	return order;
}

void cau_looks_give_up(cau_hosted *h, uint32_t client)
{
	cau_error error = {0};
	pthread_mutex_lock(&h->mutex);
	cau_looks *looks = h->looks;
	cau_order *order = looks ? take_of_client(looks, client) : NULL;
	if (looks && looks->present && looks->present->asker.client == client)
		looks->given_up = true;
	pthread_mutex_unlock(&h->mutex);
	if (!order)
		return;
	cau_fail(
		&error, CAU_BAD_STATE, "",
		"cancelled before it began: the client asked for another past view, or cancelled this one");
	cau_answer_fail(order, &error, 0);
}

double cau_looks_tires_s(const cau_looks *looks)
{
	return looks && !looks->busy && looks->past.core ? looks->idle_since_s + KEPT_S : INFINITY;
}

double cau_looks_due_s(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	double due_s = cau_looks_tires_s(h->looks);
	pthread_mutex_unlock(&h->mutex);
	return due_s;
}

void cau_looks_finish(cau_looks *looks)
{
	if (!looks)
		return;
	CAU_ASSERT(!looks->busy && !looks->waiting,
	           "session %s is destroyed while a client views its past", looks->hosted->id);
	cau_past_finish(&looks->past);
	free(looks);
}
