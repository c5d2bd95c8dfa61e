// SPDX-License-Identifier: GPL-3.0-or-later
// The session's side of the store: one batch a slice, answers after its commit.
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "hosted_session/internal.h"
#include "hosted_session/resend.h"

// Of checkpoints for each tick that a paused session is stepped: one that is stepped for long has a
// checkpoint from time to time, and a restart does not replay all of it. The disk takes each byte
// twice, in the write-ahead log and in the file. So a tick stays below 16 KiB with its log entries.
enum { REACHED_BYTES = 2048 };

cau_store_batch *cau_record_batch(cau_hosted *h)
{
	if (!h->batch) {
		h->batch = cau_store_batch_create();
		h->batch_tick = h->tick;
	}
	return h->batch;
}

// A log that misses something is only good again from the next checkpoint on. Any thread.
static void lose(cau_hosted *h, uint64_t from_tick)
{
	uint64_t known = h->lost_from;
	while (from_tick < known && !atomic_compare_exchange_weak(&h->lost_from, &known, from_tick))
		;
	h->checkpoint_wanted = true;
}

static void gap(cau_hosted *h, const cau_error *error)
{
	cau_log(CAU_LOG_ERROR, h->id, "store_refused", "status=%s reason=\"%s\"",
	        cau_status_name(error->status), error->reason);
	lose(h, h->batch && h->batch_tick < h->tick ? h->batch_tick : h->tick);
}

// The next entry of the log, at the tick of now.
static cau_store_command next_entry(cau_hosted *h, int32_t kind)
{
	if (h->logged_tick != h->tick) {
		h->logged_order = 0;
		h->logged_acts = false;
	}
	h->logged_tick = h->tick;
	h->logged_acts |= kind != CAU_STORE_REACHED;
	h->batch_acts = true;
	return (cau_store_command){.session = h->id,
	                           .branch = h->branch,
	                           .tick = h->tick,
	                           .order = h->logged_order++,
	                           .kind = kind};
}

// A checkpoint at tick T comes before the commands logged at T. Once some are with the core, this
// border is past that: the log leads here from the checkpoint before, and the next border gets one.
static bool is_past_commands(const cau_hosted *h)
{
	return h->logged_tick == h->tick && h->logged_acts;
}

void cau_record_command(cau_hosted *h, const cau_command *command, const cau_order *order,
                        const char *text, size_t text_bytes)
{
	char json[CAU_COMMAND_JSON_MAX_BYTES];
	size_t json_bytes = 0;
	h->touched = true;
	if (h->lost_from <= h->tick && is_past_commands(h))
		return; // a cut of the daemon's own, behind a command that was lost
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	cau_store_command row = next_entry(h, command->kind);
	if (order && order->client_sequence && text) {
		row.client = order->asker.client_id;
		row.sequence = (uint64_t)order->client_sequence;
		row.result = (cau_store_bytes){text, text_bytes};
	}
	cau_status status = cau_command_to_json(command, json, sizeof json, &json_bytes, &error);
	row.payload = (cau_store_bytes){json, json_bytes};
	if (!status && !batch)
		status = cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a batch");
	if (!status)
		status = cau_store_put_command(batch, &row, &error);
	if (status)
		gap(h, &error);
}

void cau_record_answer(cau_hosted *h, const cau_order *order, const char *text, size_t text_bytes)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	cau_store_answer row = {
		order->asker.client_id, (uint64_t)order->client_sequence, h->id, {text, text_bytes}};
	if (order->client_sequence && batch && cau_store_put_answer(batch, &row, &error))
		gap(h, &error);
}

void cau_record_state(cau_hosted *h)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	const char *state = cau_decided_state(h) == CAU_SESSION_RUNNING ? "running" : "paused";
	if (batch && cau_store_put_session_state(batch, h->id, state, &error))
		gap(h, &error);
}

// What was lost ends with the checkpoint of this tick, in the same batch: nobody is led through it.
static cau_status end_gap(cau_hosted *h, cau_store_batch *batch, cau_error *error)
{
	uint64_t from = atomic_exchange(&h->lost_from, UINT64_MAX);
	cau_store_gap row = {
		.session = h->id, .branch = h->branch, .from_tick = from, .before_tick = h->tick};
	cau_status status = from < h->tick ? cau_store_put_gap(batch, &row, error) : CAU_OK;
	if (status)
		lose(h, from);
	else if (from < h->batch_lost)
		h->batch_lost = from; // lost again if the batch is
	return status;
}

void cau_record_mark(cau_hosted *h)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	if (!batch || cau_store_put_mark(batch, h->id, h->branch, h->tick, &error))
		cau_log(CAU_LOG_ERROR, h->id, "mark_lost", "reason=\"%s\"", error.reason);
}

void cau_record_checkpoint(cau_hosted *h, uint64_t *hash, size_t *bytes)
{
	if (is_past_commands(h)) {
		h->checkpoint_wanted = true;
		if (hash)
			*hash = cau_session_hash(h->core);
		return;
	}
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	size_t capacity = cau_session_snapshot_bytes(h->core), count = 0;
	void *snapshot = cau_shelf_take(h->snapshot_shelf, capacity);
	cau_store_checkpoint row = {
		.session = h->id, .branch = h->branch, .tick = h->tick, .hash = cau_session_hash(h->core)};
	cau_status status = snapshot && batch
	                        ? cau_session_snapshot(h->core, snapshot, capacity, &count, &error)
	                        : cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a checkpoint");
	row.snapshot = (cau_store_bytes){snapshot, count};
	if (!status)
		status = cau_store_lend_checkpoint(batch, &row, cau_shelf_give_back, &error);
	if (status)
		cau_shelf_give_back(snapshot);
	h->checkpoint_wanted = h->batch_acts = false;
	if (!status)
		status = end_gap(h, batch, &error);
	if (status)
		gap(h, &error);
	h->touched = false;
	h->checkpoint_s = cau_monotonic_s();
	h->checkpoint_tick = h->tick;
	if (hash)
		*hash = row.hash;
	if (bytes)
		*bytes = count;
}

bool cau_record_far(cau_hosted *h)
{
	size_t checkpoint = cau_session_snapshot_bytes(h->core);
	bool whole = h->lost_from == UINT64_MAX && !h->checkpoint_wanted;
	if (whole && checkpoint > REACHED_BYTES * (h->tick - h->checkpoint_tick))
		return false;
	cau_record_checkpoint(h, NULL, NULL);
	return true;
}

void cau_record_reached(cau_hosted *h)
{
	if (cau_record_far(h))
		return;
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	cau_store_command row = next_entry(h, CAU_STORE_REACHED);
	cau_status status = batch ? cau_store_put_command(batch, &row, &error)
	                          : cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a batch");
	if (status)
		gap(h, &error);
}

void cau_record_event(cau_hosted *h, const cau_wire_timeline_event *event, cau_log_level level)
{
	static const char *const kinds[] = {
#define X(code, name) name,
		CAU_EVENT_TABLE(X)
#undef X
	};
	char text[4096]; // the longest detail, every byte escaped
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	cau_wire_event_notice notice = {.event = *event};
	cau_rpc_buffer out = {text, sizeof text - 1, 0};
	memcpy(notice.session, h->id, sizeof notice.session);
	cau_status status = cau_rpc_write_notification(&out, CAU_METHOD_EVENT, &notice, &error);
	text[status ? 0 : out.bytes] = 0;
	cau_store_event row = {.session = h->id,
	                       .branch = h->branch,
	                       .tick = (uint64_t)event->tick,
	                       .level = (int32_t)level,
	                       .kind = kinds[event->kind],
	                       .text = text};
	cau_log(level, h->id, kinds[event->kind], "tick=%llu tool=%s client=\"%s\" detail=\"%s\"",
	        (unsigned long long)event->tick, event->tool, event->client, event->detail);
	if (!status && batch)
		status = cau_store_put_event(batch, &row, &error);
	if (status)
		gap(h, &error);
}

void cau_record_reply(cau_hosted *h, const cau_reply *reply, char *text, size_t text_bytes)
{
	cau_pending *pending = reply->answer ? malloc(sizeof *pending) : NULL;
	if (!pending) {
		free(text);
		return;
	}
	*pending = (cau_pending){h->pending, *reply, text, text_bytes};
	h->pending = pending;
}

// What travels with a batch.
typedef struct commit {
	cau_hosted *hosted;
	cau_pending *pending;
	uint64_t from_tick; // what is lost if it fails
	bool making;        // the session's first rows: without them there is no session
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

// The store has not taken the session's first rows, so there is no session. While its past is
// replayed, the answer to its creator is not among the pending ones.
static void end_making(cau_hosted *h, cau_status status, const char *reason)
{
	cau_error error = {.status = status};
	snprintf(error.reason, sizeof error.reason, "%s", reason);
	h->unmade = (int)status;
	cau_hosted_end(h);
	cau_hosted_fail_creator(h, &error, cau_hosted_commit_code(status));
}

// On the store's thread.
static void committed(void *user, cau_status status, const char *reason)
{
	commit *done = user;
	if (!status && done->hosted->unmade) { // of a session whose first rows are lost
		status = (cau_status)done->hosted->unmade;
		reason = "the session could not be stored";
	}
	if (status) {
		cau_log(CAU_LOG_ERROR, done->hosted->id, "commit_failed", "status=%s reason=\"%s\"",
		        cau_status_name(status), reason);
		lose(done->hosted, done->from_tick);
		if (done->making)
			end_making(done->hosted, status, reason);
	}
	answer_all(done->pending, status, reason);
	if (atomic_fetch_sub(&done->hosted->commits, 1) == 1) {
		cau_decide(done->hosted,
		           &(cau_logic_event){.kind = CAU_LOGIC_COMMITTED, .time_s = cau_monotonic_s()});
		if (done->hosted->drain_wanted)
			cau_worker_pool_wake(done->hosted->around->pool, &done->hosted->task);
	}
	cau_hosted_release(done->hosted);
	free(done);
}

cau_status cau_record_check(cau_hosted *h, cau_error *error)
{
	if (h->lost_from <= h->tick && !is_past_commands(h))
		cau_record_checkpoint(h, NULL, NULL);
	if (h->lost_from > h->tick)
		return CAU_OK;
	return cau_fail(error, CAU_IO, "",
	                "an earlier command of this tick was not stored: step or resume the session");
}

static bool is_being_made(const cau_hosted *h)
{
	return h->unanswered && h->origin.kind != CAU_ORIGIN_STORE;
}

void cau_record_commit(cau_hosted *h)
{
	cau_error error = {0};
	cau_pending *pending = reversed(h->pending);
	h->pending = NULL;
	if (!h->batch) {
		answer_all(pending, pending ? CAU_NO_MEMORY : CAU_OK, "no command could be stored");
		return;
	}
	// The store may have failed meanwhile what comes before the entries of this batch.
	cau_status status = h->batch_acts ? cau_record_check(h, &error) : CAU_OK;
	commit *travelling = status ? NULL : malloc(sizeof *travelling);
	if (!status && !travelling)
		status = cau_fail(&error, CAU_NO_MEMORY, NULL, "no memory for a commit");
	if (!status) {
		uint64_t from = h->batch_tick < h->batch_lost ? h->batch_tick : h->batch_lost;
		*travelling = (commit){cau_hosted_share(h), pending, from, is_being_made(h)};
		atomic_fetch_add(&h->commits, 1);
		status = cau_store_submit(h->around->store, h->batch, committed, travelling, &error);
	}
	if (status) {
		gap(h, &error);
		lose(h, h->batch_lost);
		cau_store_batch_destroy(h->batch);
		answer_all(pending, status, error.reason);
		if (is_being_made(h))
			end_making(h, status, error.reason);
		if (travelling) {
			atomic_fetch_sub(&h->commits, 1);
			cau_hosted_release(h);
		}
		free(travelling);
	}
	h->batch = NULL;
	h->batch_acts = false;
	h->batch_lost = UINT64_MAX;
}

static cau_status send_again(void *user, const cau_store_answer *answer)
{
	const cau_order *order = user;
	cau_resend_answer(&order->reply, answer->result.data, answer->result.bytes);
	return CAU_OK;
}

cau_status cau_record_resend(cau_hosted *h, const cau_order *order, cau_error *error)
{
	if (!order->client_sequence)
		return CAU_NOT_FOUND;
	return cau_store_read_answer(h->around->store, order->asker.client_id,
	                             (uint64_t)order->client_sequence, send_again, (void *)order,
	                             error);
}
