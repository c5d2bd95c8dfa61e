// SPDX-License-Identifier: Apache-2.0
// The list of requests without an answer, in the order in which they were sent.
#include "library/internal.h"

void cau_pending_add(cau_client *client, cau_client_pending *pending)
{
	pending->next = NULL;
	if (client->last_pending)
		client->last_pending->next = pending;
	else
		client->first_pending = pending;
	client->last_pending = pending;
}

cau_client_pending *cau_pending_take(cau_client *client, int64_t id)
{
	cau_client_pending *before = NULL, *pending = client->first_pending;
	while (pending && pending->id != id) {
		before = pending;
		pending = pending->next;
	}
	if (!pending)
		return NULL;
	if (before)
		before->next = pending->next;
	else
		client->first_pending = pending->next;
	if (client->last_pending == pending)
		client->last_pending = before;
	return pending;
}
