// SPDX-License-Identifier: GPL-3.0-or-later
// References to a session, its creator's reply, and its constant values.
#include "hosted_session/hosted.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hosted_session/internal.h"
#include "hosted_session/life.h"
#include "hosted_session/slice.h"

cau_hosted *cau_hosted_share(cau_hosted *h)
{
	atomic_fetch_add(&h->references, 1);
	return h;
}

void cau_reply_moved(const cau_reply *reply, const cau_moved_to *to)
{
	cau_error error = {0};
	cau_fail(&error, CAU_NOT_FOUND, "params.session", "the session is now `%s`", to->session);
	cau_outcome outcome = {.error = &error, .code = CAU_RPC_MOVED, .moved = to};
	cau_reply_answer(reply, &outcome);
}

void cau_hosted_refuse_gone(const cau_hosted_life *life, cau_order *order)
{
	if (*life->moved.session) {
		cau_reply_moved(&order->reply, &life->moved);
		free(order);
		return;
	}
	cau_error error = {.status = CAU_NOT_FOUND, .reason = "the session is gone"};
	cau_answer_fail(order, &error, CAU_RPC_NOT_HERE);
}

void cau_hosted_end(cau_hosted *h)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_END, .time_s = cau_monotonic_s()});
	// `ended` is set after the decision: a thread that sees `ended` may refuse waiting orders, and
	// this refusal needs the decision
	h->life.ended = true;
	cau_worker_pool_wake(h->identity.around->pool, &h->task);
}

bool cau_hosted_take_creator(cau_hosted_creation *creation, cau_reply *reply)
{
	if (!atomic_exchange(&creation->waits, false))
		return false;
	*reply = creation->reply;
	return true;
}

void cau_hosted_fail_creator(cau_hosted_creation *creation, const cau_error *error, int32_t code)
{
	cau_reply reply;
	if (cau_hosted_take_creator(creation, &reply))
		cau_reply_fail(&reply, error, code);
}

void cau_hosted_release(cau_hosted *h)
{
	if (!h || atomic_fetch_sub(&h->references, 1) != 1)
		return;
	CAU_ASSERT(h->decisions.logic->count == 0 && !h->decisions.logic->stepping && !h->reads.first,
	           "session %s goes with %d orders unanswered", h->identity.id,
	           h->decisions.logic->count);
	CAU_ASSERT(!h->past.busy && !h->past.waiting,
	           "session %s is destroyed while a client views its past", h->identity.id);
	cau_past_core_finish(&h->past.core);
	cau_replay_finish(&h->replay);
	cau_streams_finish(&h->frames.streams);
	cau_store_batch_destroy(h->record.batch);
	cau_shelf_release(h->record.shelf);
	cau_shelf_release(h->reads.copies);
	cau_session_destroy(h->core.session);
	cau_building_release(h->identity.around, &h->creation.memory_held);
	pthread_mutex_destroy(&h->suspension.lock);
	pthread_mutex_destroy(&h->published.lock);
	pthread_mutex_destroy(&h->refusals.lock);
	pthread_mutex_destroy(&h->reads.lock);
	pthread_mutex_destroy(&h->past.lock);
	cau_decisions_finish(&h->decisions);
	free(h->identity.scene);
	free(h->core.described);
	free(h->identity.meshes);
	free(h);
}

const char *cau_hosted_id(const cau_hosted *h)
{
	return h->identity.id;
}

uint32_t cau_hosted_number(const cau_hosted *h)
{
	return h->identity.number;
}

const cau_scene_def *cau_hosted_scene(const cau_hosted *h)
{
	return h->identity.scene;
}

bool cau_hosted_ended(cau_hosted *h)
{
	return h->life.ended;
}

bool cau_hosted_starting(cau_hosted *h)
{
	return h->creation.unanswered && !h->life.ended;
}

bool cau_hosted_made_by(const cau_hosted *h, const char *client_id, int64_t client_sequence)
{
	return client_sequence && h->identity.creator_sequence == client_sequence &&
	       strcmp(h->identity.creator.client_id, client_id) == 0;
}

bool cau_hosted_drained(cau_hosted *h)
{
	return h->life.drained || h->life.ended;
}
