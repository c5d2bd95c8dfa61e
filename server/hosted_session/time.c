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
	cau_decided decided = cau_decided_now(h);
	if (failed && !*decided.fault) { // it is gone
		cau_hosted_refuse_gone(h, order);
		return;
	}
	if (failed) {
		cau_fail(&error, CAU_FAULTED, "", "%s", decided.fault);
		cau_answer_fail(order, &error, CAU_RPC_FAULTED);
		return;
	}
	if (order->kind == CAU_ORDER_ADVANCE) {
		cau_advance_answer(h, order);
		return;
	}
	cau_event_end_cut(h);
	h->dirty = true; // the last state is shown, whatever the streams' rates
	cau_record_reached(h);
	cau_answer_changed(h, CAU_CHANGE_STEPPED, order->asker.name);
	cau_answer_order(h, order, &result);
}

cau_outcome_kind cau_apply_speed(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	answer_summary(h, order, CAU_CHANGE_SPEED);
	return CAU_DONE;
}

const cau_named_snapshot *cau_snapshot_find(const cau_hosted *h, const char *name)
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
	if (cau_snapshot_find(h, order->as.name)) {
		return fail(order, CAU_ALREADY_EXISTS, "params.name", "a snapshot has this name");
	}
	if (h->snapshot_count == SNAPSHOT_COUNT) {
		return fail(order, CAU_LIMIT, "params.name", "the session has 64 snapshots, the most");
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
