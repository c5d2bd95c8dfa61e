// SPDX-License-Identifier: GPL-3.0-or-later
// Builds a session as a job of the builder. Afterwards the session returns to the workers, or ends.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hosted_session/internal.h"
#include "hosted_session/life.h"
#include "hosted_session/slice.h"

// First estimate of a step's time, s for each vertex: 0.12 s for a sheet of 250,000 vertices.
#define STEPPED_VERTEX_S 5e-7

// ---- the job
typedef struct building {
	cau_job job; // must be the first member
	cau_hosted *hosted;
} building;

static bool is_resend(const cau_order *order, const cau_order *first)
{
	return order->client_sequence && order->client_sequence == first->client_sequence &&
	       strcmp(order->asker.client_id, first->asker.client_id) == 0;
}

// Answers a session.destroy that was sent twice while the session was built. The answer is stored
// only once.
static void answer_resend(cau_hosted_record *record, cau_order *order)
{
	cau_error error = {0};
	size_t bytes = 0;
	char *text = cau_answer_text(order->reply.method, &(cau_wire_nothing){0}, &bytes, &error);
	if (text)
		cau_record_reply(record, &order->reply, text, bytes);
	else
		cau_reply_fail(&order->reply, &error, CAU_RPC_INTERNAL);
	free(order);
}

// Answers the session.destroy orders. The first one destroys the session. Its resends get the same
// answer. All other orders are refused, because the session is gone.
static void answer_destroyers(cau_hosted *h)
{
	cau_order *first = h->suspension.destroyers;
	for (cau_order *order = first->next, *next; order; order = next) {
		next = order->next;
		if (is_resend(order, first))
			answer_resend(&h->record, order);
		else
			cau_hosted_refuse_gone(&h->life, order);
	}
	cau_hosted_destroy(h, first,
	                   h->creation.origin.kind == CAU_ORIGIN_STORE || !h->creation.unanswered);
	h->suspension.destroyers = NULL;
}

// Ends the session in a last slice of the builder. The store is flushed first, because a resend
// must find its earlier answer on the disk. No later tick border could repeat that search.
static void come_to_an_end(cau_hosted *h)
{
	cau_store_flush(h->identity.around->store);
	if (!*h->life.moved.session &&
	    cau_suspension_is_cancelled(h)) // a moved session is destroyed on its new daemon
		answer_destroyers(h);
	cau_hosted_refuse_rest(h);
	cau_hosted_end_slice(h);
	for (cau_order *late = cau_suspension_end(&h->suspension), *next; late; late = next) {
		next = late->next;
		cau_hosted_refuse_gone(&h->life, late);
	}
}

static void come_back(cau_hosted *h)
{
	cau_error error = {0};
	cau_hosted_end_slice(h);
	for (cau_order *late = cau_suspension_end(&h->suspension), *next; late;
	     late = next) { // orders that came after the last border
		next = late->next;
		if (cau_hosted_submit(h, late, &error))
			cau_answer_fail(late, &error, 0);
	}
	cau_worker_pool_wake(h->identity.around->pool, &h->task);
}

void cau_building_over(cau_hosted *h)
{
	if (h->life.ended)
		come_to_an_end(h);
	else
		come_back(h);
}

static void end(building *b)
{
	cau_hosted *h = b->hosted;
	if (h->creation.replaying) // workers continue the replay, in slices
		cau_suspension_name_stage(&h->suspension, "replaying");
	h->pace.piece_s = STEPPED_VERTEX_S * h->core.info.vertex_count;
	cau_building_over(h);
	cau_hosted_release(h);
	free(b);
}

static void drop(cau_job *job)
{
	building *b = (building *)job;
	b->hosted->creation.unwanted = true;
	cau_hosted_fail_start(b->hosted, &cau_daemon_ends);
	end(b);
}

// ---- a session that arrives by a move: it is built and waits to be accepted ---------------------

static void wait_to_come(building *b)
{
	cau_hosted *h = b->hosted;
	cau_error error = {0};
	cau_outcome outcome = {0};
	cau_wire_move_held result = {.tick = (int64_t)h->replay.tick,
	                             .hash = cau_session_hash(h->core.session),
	                             .has_exact = true,
	                             .exact = h->replay.exact};
	cau_reply reply;
	char *text = cau_answer_text(h->creation.reply.method, &result, &outcome.text_bytes, &error);
	if (!text) {
		drop(&b->job);
		return;
	}
	cau_replay_finish(&h->replay);
	bool waits = cau_hosted_take_creator(&h->creation, &reply);
	h->creation.job = &b->job;
	outcome.text = text;
	if (waits)
		cau_reply_answer(&reply, &outcome); // from here on cau_hosted_come may be called
	free(text);
}

static void run_again(cau_job *job)
{
	building *b = (building *)job;
	cau_hosted_resume(b->hosted);
	end(b);
}

static void leave_to_builder(cau_hosted_creation *creation, const cau_hosted_identity *identity,
                             void (*run)(cau_job *job))
{
	cau_job *job = creation->job;
	CAU_ASSERT(job != NULL, "session %s waits for nothing", identity->id);
	creation->job = NULL;
	job->run = run;
	cau_builder_submit(identity->around->mover, job);
}

void cau_hosted_come(cau_hosted *h, int64_t branch, bool paused, const cau_reply *reply)
{
	h->creation.incoming = false;
	h->creation.came = true;
	h->creation.origin.branch = branch;
	h->creation.pause_at_start = paused;
	h->creation.reply = *reply;
	h->creation.waits = true;
	leave_to_builder(&h->creation, &h->identity, run_again);
}

void cau_hosted_give_up(cau_hosted *h)
{
	leave_to_builder(&h->creation, &h->identity, drop);
}

static void run(cau_job *job)
{
	building *b = (building *)job;
	cau_hosted_start(b->hosted);
	if (b->hosted->creation.incoming && !b->hosted->life.ended)
		wait_to_come(b);
	else
		end(b);
}

cau_status cau_building_begin(cau_hosted *h, cau_error *error)
{
	building *b = malloc(sizeof *b);
	if (!b)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to build a session");
	*b = (building){
		.job = {.run = run, .drop = drop, .expected_s = cau_building_expects_s(h->identity.scene)},
		.hosted = cau_hosted_share(h)};
	cau_builder_submit(h->identity.around->builder, &b->job);
	return CAU_OK;
}
