// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/record.h"

#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

const cau_named_snapshot *cau_history_find(const cau_hosted_history *history, const char *name)
{
	for (int32_t i = history->snapshot_count; i-- > 0;)
		if (strcmp(history->snapshots[i].name, name) == 0)
			return &history->snapshots[i];
	return NULL;
}

// ---- from the store -----------------------------------------------------------------------------

static cau_status take_beginning(void *user, const cau_store_event *event)
{
	cau_hosted_history *history = user;
	history->first_tick = event->tick;
	return CAU_OK;
}

// Reads "name=five branch=0" from anywhere in the event's detail.
static bool read_snapshot(const char *text, cau_named_snapshot *made)
{
	static const char name[] = "name=", branch[] = " branch=";
	const char *at = strstr(text, name), *end = at ? strstr(at, branch) : NULL;
	if (!end)
		return false;
	at += strlen(name);
	size_t bytes = (size_t)(end - at);
	if (bytes >= sizeof made->name)
		return false;
	memcpy(made->name, at, bytes);
	made->name[bytes] = 0;
	made->branch = strtoll(end + strlen(branch), NULL, 10);
	return true;
}

static cau_status take_snapshot(void *user, const cau_store_event *event)
{
	cau_hosted_history *history = user;
	cau_named_snapshot *made = &history->snapshots[history->snapshot_count];
	if (history->snapshot_count < SNAPSHOT_COUNT && read_snapshot(event->text, made)) {
		made->tick = event->tick;
		history->snapshot_count++;
	}
	return CAU_OK;
}

static cau_status count_branch(void *user, const cau_store_branch *branch)
{
	cau_hosted_history *history = user;
	if (branch->branch >= history->next_branch)
		history->next_branch = branch->branch + 1;
	return CAU_OK;
}

cau_status cau_history_load(cau_hosted_history *history, const cau_hosted_identity *identity,
                            cau_error *error)
{
	cau_store *store = identity->around->store;
	const char *id = identity->id;
	cau_status status = cau_store_read_branches(store, id, count_branch, history, error);
	if (!status)
		status = cau_store_read_events(store, id, "created", 1, take_beginning, history, error);
	if (!status)
		status = cau_store_read_events(store, id, "snapshot", SNAPSHOT_COUNT, take_snapshot,
		                               history, error);
	return status;
}

// ---- orders about named snapshots ---------------------------------------------------------------

cau_outcome_kind cau_apply_snapshot(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	cau_wire_snapshot_result result = {.tick = (int64_t)h->core.tick};
	char detail[128];
	size_t bytes = 0;
	if (!*order->as.name)
		snprintf(order->as.name, sizeof order->as.name, "tick-%llu-%lld",
		         (unsigned long long)h->core.tick, (long long)h->history.branch);
	if (cau_history_find(&h->history, order->as.name)) {
		return cau_answer_refuse(order, CAU_ALREADY_EXISTS, "params.name",
		                         "a snapshot of the session already has this name");
	}
	if (h->history.snapshot_count == SNAPSHOT_COUNT) {
		return cau_answer_refuse(order, CAU_LIMIT, "params.name",
		                         "the session already has 64 snapshots, which is the limit");
	}
	cau_record_checkpoint(&h->record, &result.hash, &bytes);
	cau_named_snapshot *made = &h->history.snapshots[h->history.snapshot_count++];
	*made = (cau_named_snapshot){.branch = h->history.branch, .tick = h->core.tick};
	memcpy(made->name, order->as.name, sizeof made->name);
	memcpy(result.name, order->as.name, sizeof result.name);
	result.byte_count = (int64_t)bytes;
	snprintf(detail, sizeof detail, "name=%s branch=%lld hash=%016llx", made->name,
	         (long long)h->history.branch, (unsigned long long)result.hash);
	cau_record_mark(&h->record);
	cau_timeline_add(&h->timeline, CAU_EVENT_SNAPSHOT, NULL, order->asker.name, 0, detail);
	cau_answer_order(&h->record, order, &result);
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
	cau_wire_snapshot_list result = {
		.snapshots = {named, h->history.snapshot_count, SNAPSHOT_COUNT}};
	for (int32_t i = 0; i < h->history.snapshot_count; i++) {
		const cau_named_snapshot *from = &h->history.snapshots[i];
		named[i] = (cau_wire_named_snapshot){.tick = (int64_t)from->tick, .branch = from->branch};
		memcpy(named[i].name, from->name, sizeof named[i].name);
	}
	qsort(named, (size_t)h->history.snapshot_count, sizeof *named, by_tick);
	cau_answer_order(&h->record, order, &result);
}
