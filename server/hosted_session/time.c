// SPDX-License-Identifier: GPL-3.0-or-later
// Orders about time and history.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

static void answer_summary(cau_hosted *h, cau_order *order, int change)
{
	cau_wire_session_summary summary;
	cau_answer_changed(h, change, order->asker.name);
	cau_hosted_summary(h, &summary);
	cau_answer_order(h, order, &summary);
}

static cau_outcome_kind fail(cau_order *order, cau_status status, const char *path,
                             const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, path, "%s", reason);
	cau_answer_fail(order, &error, 0);
	return CAU_NOT_DONE;
}

cau_outcome_kind cau_apply_pause(cau_hosted *h, cau_order *order, const cau_action *action)
{
	if (action->changed) {
		h->realtime_factor = 0;
		cau_event_end_cut(h);
		cau_record_state(h);
		cau_record_checkpoint(h, NULL, NULL);
	}
	h->dirty = true;
	if (order)
		answer_summary(h, order, CAU_CHANGE_PAUSED);
	else
		cau_answer_changed(h, CAU_CHANGE_PAUSED, NULL);
	return CAU_DONE;
}

cau_outcome_kind cau_apply_resume(cau_hosted *h, cau_order *order, const cau_action *action)
{
	if (action->changed) {
		h->window_s = cau_monotonic_s();
		h->window_tick = h->tick;
		cau_record_state(h);
	}
	answer_summary(h, order, CAU_CHANGE_RESUMED);
	return CAU_DONE;
}

// The ticks are made one by one, and the order is answered after the last: cau_time_stepped.
cau_outcome_kind cau_apply_step(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)h, (void)order, (void)action;
	return CAU_DONE;
}

void cau_time_stepped(cau_hosted *h, cau_order *order, bool failed)
{
	cau_wire_tick_result result = {(int64_t)h->tick, 0};
	cau_error error = {0};
	if (failed && h->ended) {
		cau_hosted_refuse_gone(order);
		return;
	}
	if (failed) {
		cau_fail(&error, CAU_FAULTED, "", "%s", h->logic->fault);
		cau_answer_fail(order, &error, CAU_RPC_FAULTED);
		return;
	}
	cau_event_end_cut(h);
	h->dirty = true; // the last state is shown, whatever the streams' rates
	cau_record_checkpoint(h, NULL, NULL);
	cau_answer_changed(h, CAU_CHANGE_STEPPED, order->asker.name);
	cau_answer_order(h, order, &result);
}

cau_outcome_kind cau_apply_speed(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	answer_summary(h, order, CAU_CHANGE_SPEED);
	return CAU_DONE;
}

static const cau_named_snapshot *find_snapshot(const cau_hosted *h, const char *name)
{
	for (int32_t i = h->snapshot_count; i-- > 0;)
		if (strcmp(h->snapshots[i].name, name) == 0)
			return &h->snapshots[i];
	return NULL;
}

cau_outcome_kind cau_apply_snapshot(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	cau_wire_snapshot_result result = {.tick = (int64_t)h->tick};
	char detail[128];
	size_t bytes = 0;
	if (!*order->as.name)
		snprintf(order->as.name, sizeof order->as.name, "tick-%llu-%lld",
		         (unsigned long long)h->tick, (long long)h->branch);
	if (find_snapshot(h, order->as.name)) {
		return fail(order, CAU_ALREADY_EXISTS, "params.name", "a snapshot has this name");
	}
	if (h->snapshot_count == SNAPSHOT_COUNT) {
		return fail(order, CAU_LIMIT, "params.name", "the session has 64 snapshots");
	}
	cau_record_checkpoint(h, &result.hash, &bytes);
	cau_named_snapshot *made = &h->snapshots[h->snapshot_count++];
	*made = (cau_named_snapshot){.branch = h->branch, .tick = h->tick};
	memcpy(made->name, order->as.name, sizeof made->name);
	memcpy(result.name, order->as.name, sizeof result.name);
	result.byte_count = (int64_t)bytes;
	snprintf(detail, sizeof detail, "name=%s branch=%lld hash=%016llx", made->name,
	         (long long)h->branch, (unsigned long long)result.hash);
	cau_record_mark(h);
	cau_event_add(h, CAU_EVENT_SNAPSHOT, NULL, order->asker.name, 0, detail);
	cau_answer_order(h, order, &result);
	return CAU_DONE;
}

static int by_tick(const void *a, const void *b)
{
	const cau_wire_named_snapshot *x = a, *y = b;
	if (x->tick != y->tick)
		return x->tick < y->tick ? -1 : 1;
	return strcmp(x->name, y->name);
}

void cau_apply_snapshots(cau_hosted *h, cau_order *order)
{
	cau_wire_named_snapshot named[SNAPSHOT_COUNT];
	cau_wire_snapshot_list result = {.snapshots = {named, h->snapshot_count, SNAPSHOT_COUNT}};
	for (int32_t i = 0; i < h->snapshot_count; i++) {
		const cau_named_snapshot *from = &h->snapshots[i];
		named[i] = (cau_wire_named_snapshot){.tick = (int64_t)from->tick, .branch = from->branch};
		memcpy(named[i].name, from->name, sizeof named[i].name);
	}
	qsort(named, (size_t)h->snapshot_count, sizeof *named, by_tick);
	cau_answer_order(h, order, &result);
}

// Before the past is read, all of it must be in the store. What the store lacks is told to it by
// the checkpoint that ends it; until then nobody goes there. False: the order is answered.
static bool store_past(cau_hosted *h, cau_order *order, int64_t branch, uint64_t tick)
{
	cau_error error = {0};
	if (h->lost_from != UINT64_MAX)
		cau_record_checkpoint(h, NULL, NULL);
	cau_record_commit(h);
	cau_store_flush(h->around->store);
	cau_status status = CAU_OK;
	if (branch == h->branch && tick > h->lost_from)
		status = cau_fail(&error, CAU_BAD_VALUE, "params.tick",
		                  "what happened from tick %llu on could not be stored",
		                  (unsigned long long)h->lost_from);
	if (!status)
		status = cau_store_check_reach(h->around->store, h->id, branch, tick, &error);
	if (status)
		cau_answer_fail(order, &error, 0);
	return !status;
}

cau_outcome_kind cau_apply_back(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	cau_error error = {0};
	int64_t branch = h->branch;
	uint64_t tick = order->kind == CAU_ORDER_RESET ? h->first_tick : order->as.tick;
	if (order->kind == CAU_ORDER_RESTORE) {
		const cau_named_snapshot *snapshot = find_snapshot(h, order->as.name);
		if (!snapshot)
			return fail(order, CAU_NOT_FOUND, "params.name", "no snapshot has this name");
		branch = snapshot->branch;
		tick = snapshot->tick;
	} else if (tick > h->tick) {
		return fail(order, CAU_BAD_VALUE, "params.tick", "beyond the present");
	}
	cau_event_end_cut(h);
	if (!store_past(h, order, branch, tick))
		return CAU_NOT_DONE;
	if (cau_replay_begin(h, h->id, branch, tick, order, &error)) {
		cau_answer_fail(order, &error, 0);
		return CAU_NOT_DONE;
	}
	h->branch = branch;
	return CAU_DONE;
}

static int change_of(cau_order_kind kind, int *event)
{
	*event = kind == CAU_ORDER_RESET     ? CAU_EVENT_RESET
	         : kind == CAU_ORDER_RESTORE ? CAU_EVENT_RESTORE
	                                     : CAU_EVENT_REWIND;
	return kind == CAU_ORDER_RESET     ? CAU_CHANGE_RESET
	       : kind == CAU_ORDER_RESTORE ? CAU_CHANGE_RESTORED
	                                   : CAU_CHANGE_REWOUND;
}

static void open_branch(cau_hosted *h)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	cau_store_branch row = {
		.session = h->id, .branch = h->next_branch, .parent = h->branch, .fork_tick = h->tick};
	cau_status status = batch ? cau_store_put_branch(batch, &row, &error) : CAU_NO_MEMORY;
	if (status)
		cau_log(CAU_LOG_ERROR, h->id, "branch_lost", "reason=\"%s\"", error.reason);
	h->branch = h->next_branch++;
	h->logged_order = 0;
	h->logged_tick = UINT64_MAX;
}

void cau_back_arrived(cau_hosted *h, cau_order *order)
{
	int event;
	int change = change_of(order->kind, &event);
	int state = cau_decided_state(h);
	cau_events_load(h);
	open_branch(h);
	cau_event_add(h, event, NULL, order->asker.name, 0, NULL);
	cau_record_checkpoint(h, NULL, NULL);
	cau_decide_arrived(h, state == CAU_SESSION_FAULTED ? CAU_SESSION_PAUSED : state,
	                   "the session went back");
	cau_frames_restart(h);
	cau_record_state(h);
	h->window_s = cau_monotonic_s();
	h->window_tick = h->tick;
	cau_wire_restored result = {
		.tick = (int64_t)h->tick, .epoch = h->epoch, .branch = h->branch, .exact = h->replay.exact};
	cau_answer_changed(h, change, order->asker.name);
	cau_answer_order(h, order, &result);
}

cau_outcome_kind cau_apply_fork(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	uint64_t tick = order->as.fork.has_tick ? order->as.fork.tick : h->tick;
	if (tick > h->tick)
		return fail(order, CAU_BAD_VALUE, "params.tick", "beyond the present");
	if (tick == h->tick)
		cau_record_checkpoint(h, NULL, NULL);
	if (!store_past(h, order, h->branch, tick))
		return CAU_NOT_DONE;
	h->around->fork(h->around->user, h, order, tick);
	free(order);
	return CAU_DONE;
}

bool cau_hosted_destroy(cau_hosted *h, cau_order *order, bool stored)
{
	cau_error error = {0};
	cau_wire_nothing result = {0};
	cau_store_batch *batch = cau_record_batch(h);
	if (stored && (!batch || cau_store_delete_session(batch, h->id, &error))) {
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory to destroy it");
		cau_answer_fail(order, &error, 0);
		return false;
	}
	cau_answer_changed(h, CAU_CHANGE_DESTROYED, order->asker.name);
	cau_log(CAU_LOG_INFO, h->id, "destroyed", "client=\"%s\"", order->asker.name);
	cau_answer_order(h, order, &result);
	return true;
}

cau_outcome_kind cau_apply_destroy(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	if (!cau_hosted_destroy(h, order, true))
		return CAU_NOT_DONE;
	h->ended = true;
	return CAU_DONE;
}
