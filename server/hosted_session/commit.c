// SPDX-License-Identifier: GPL-3.0-or-later
// Commits a slice's batch to the disk. After the commit, the waiting answers are sent, or a loss is
// noted. A request that is sent again gets the stored answer.
#include <stdlib.h>

#include "hosted_session/internal.h"
#include "hosted_session/sink.h"
#include "hosted_session/slice.h"

// Data for the store's thread when a batch is committed.
typedef struct commit {
	cau_hosted *hosted;
	cau_pending *pending;
	uint64_t from_tick; // if the commit fails, the log lacks entries from this tick on
	bool making;        // the batch has the session's first rows, without which there is no session
	// The session was started when the batch was submitted, so the answer to the creator, or to a
	// move, is in it or in an earlier batch.
	bool started;
} commit;

static cau_pending *reversed(cau_pending *list)
{
	cau_pending *turned = NULL;
	for (cau_pending *next; list; list = next) {
		next = list->next;
		list->next = turned;
		turned = list;
	}
	return turned;
}

int32_t cau_hosted_commit_code(cau_status status)
{
	return status == CAU_IO || status == CAU_LIMIT ? CAU_RPC_STORE_FULL : 0;
}

static void answer_all(cau_pending *list, cau_status status, const char *reason)
{
	cau_error error = {.status = status};
	snprintf(error.reason, sizeof error.reason, "%s", reason);
	for (cau_pending *next; list; list = next) {
		next = list->next;
		cau_outcome outcome = {.text = list->text, .text_bytes = list->text_bytes};
		if (status)
			outcome = (cau_outcome){.error = &error, .code = cau_hosted_commit_code(status)};
		cau_reply_answer(&list->reply, &outcome);
		free(list->text);
		free(list);
	}
}

// Ends a session whose first rows the store rejected. Also fails the creator's reply, because
// during a replay this reply is not among the pending answers.
static void end_making(cau_hosted *h, cau_status status, const char *reason)
{
	cau_error error = {.status = status};
	snprintf(error.reason, sizeof error.reason, "%s", reason);
	h->commits.unmade = (int)status;
	cau_hosted_end(h);
	cau_hosted_fail_creator(&h->creation, &error, cau_hosted_commit_code(status));
}

// Called on the store's thread after a commit. Sends the answers that waited for it, or notes the
// loss.
static void committed(void *user, cau_status status, const char *reason)
{
	commit *done = user;
	if (!status && done->hosted->commits.unmade) { // the session's first rows are lost
		status = (cau_status)done->hosted->commits.unmade;
		reason = "the session could not be stored";
	}
	if (status) {
		cau_log(CAU_LOG_ERROR, done->hosted->identity.id, "commit_failed",
		        "status=%s reason=\"%s\"", cau_status_name(status), reason);
		cau_commits_lose(&done->hosted->commits, done->from_tick);
		if (done->making)
			end_making(done->hosted, status, reason);
	}
	// This comes before the answers: whoever created or moved the session may use it at once, while
	// the thread that submitted the batch still ends its slice.
	if (done->started && !status)
		done->hosted->creation.unanswered = false;
	answer_all(done->pending, status, reason);
	if (atomic_fetch_sub(&done->hosted->commits.under_way, 1) == 1) {
		cau_decide(done->hosted,
		           &(cau_logic_event){.kind = CAU_LOGIC_COMMITTED, .time_s = cau_monotonic_s()});
		if (done->hosted->life.drain_wanted)
			cau_worker_pool_wake(done->hosted->identity.around->pool, &done->hosted->task);
	}
	cau_hosted_release(done->hosted);
	free(done);
}

static bool is_being_made(const cau_hosted_creation *creation)
{
	return creation->unanswered && creation->origin.kind != CAU_ORIGIN_STORE;
}

void cau_record_commit(cau_hosted *h)
{
	cau_error error = {0};
	cau_pending *pending = reversed(h->record.pending);
	h->record.pending = NULL;
	if (!h->record.batch) {
		answer_all(pending, pending ? CAU_NO_MEMORY : CAU_OK, "no command could be stored");
		return;
	}
	// The log entries of this batch need all earlier batches, and an earlier batch may have failed
	// in the meantime.
	cau_status status = h->record.batch_acts ? cau_record_check(&h->record, &error) : CAU_OK;
	commit *travelling = status ? NULL : malloc(sizeof *travelling);
	if (!status && !travelling)
		status = cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a commit");
	if (!status) {
		uint64_t from = h->record.batch_tick < h->record.batch_lost ? h->record.batch_tick
		                                                            : h->record.batch_lost;
		bool making = is_being_made(&h->creation);
		*travelling = (commit){cau_hosted_share(h), pending, from, making, !h->creation.starting};
		atomic_fetch_add(&h->commits.under_way, 1);
		status = cau_store_submit(h->identity.around->store, h->record.batch, committed, travelling,
		                          &error);
	}
	if (status) {
		cau_record_gap(&h->record, &error);
		cau_commits_lose(&h->commits, h->record.batch_lost);
		cau_store_batch_destroy(h->record.batch);
		answer_all(pending, status, error.reason);
		if (is_being_made(&h->creation))
			end_making(h, status, error.reason);
		if (travelling) {
			atomic_fetch_sub(&h->commits.under_way, 1);
			cau_hosted_release(h);
		}
		free(travelling);
	}
	h->record.batch = NULL;
	h->record.batch_acts = false;
	h->record.batch_lost = UINT64_MAX;
}

// ---- requests that were sent before -------------------------------------------------------------

static cau_status send_again(void *user, const cau_store_answer *answer)
{
	const cau_order *order = user;
	cau_resend_answer(&order->reply, answer->result.data, answer->result.bytes);
	return CAU_OK;
}

// Looks up the stored answer of a request that was sent again. Returns CAU_OK if the answer was
// sent, CAU_NOT_FOUND if the order is new, and CAU_BAD_STATE if the order must wait.
// CAU_ALREADY_EXISTS: the order was done, but its answer is no longer stored.
static cau_status look_up(const cau_hosted_identity *identity, const cau_order *order,
                          cau_error *error)
{
	if (!order->client_sequence)
		return CAU_NOT_FOUND;
	return cau_store_read_answer(identity->around->store, order->asker.client_id,
	                             (uint64_t)order->client_sequence, send_again, (void *)order,
	                             error);
}

cau_outcome_kind cau_record_resend(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	if (h->record.pending) // the answer to the earlier order may be in this slice's batch
		cau_record_commit(h);
	cau_status status = look_up(&h->identity, order, &error);
	if (status == CAU_BAD_STATE)
		return CAU_POSTPONED;
	if (status == CAU_OK) {
		free(order);
		return CAU_NOT_DONE;
	}
	if (status != CAU_ALREADY_EXISTS)
		return CAU_DONE;
	snprintf(error.path, sizeof error.path, "params.client_sequence");
	cau_answer_fail(order, &error, CAU_RPC_SEQUENCE_PAST);
	return CAU_NOT_DONE;
}
