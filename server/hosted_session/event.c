// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, for the timeline, for everybody who watches, and for the store. The newest events
// of the present line are in memory; older ones are read from the store.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

static cau_wire_timeline_event *newest(cau_hosted *h)
{
	return h->event_count ? &h->events[(h->event_count - 1) % EVENT_COUNT] : NULL;
}

static void tell(cau_hosted *h, const cau_wire_timeline_event *what)
{
	cau_wire_event_notice params = {.event = *what};
	cau_audience audience = {CAU_AUDIENCE_SESSION, h->number};
	snprintf(params.session, sizeof params.session, "%s", h->id);
	cau_answer_notify(h, audience, CAU_METHOD_EVENT, &params);
}

static void publish(cau_hosted *h, const cau_wire_timeline_event *event)
{
	bool trouble = event->kind == CAU_EVENT_WATCHDOG || event->kind == CAU_EVENT_FAULT;
	cau_record_event(h, event, trouble ? CAU_LOG_WARNING : CAU_LOG_INFO);
	tell(h, event);
}

// ---- cuts ---------------------------------------------------------------------------------------
// Those of neighbouring ticks are one event, which is told and stored once it is whole.
void cau_event_end_cut(cau_hosted *h)
{
	if (!h->cut_open)
		return;
	h->cut_open = false;
	publish(h, newest(h));
}

void cau_event_settle(cau_hosted *h)
{
	if (h->cut_open && h->tick > (uint64_t)newest(h)->tick + CUT_MERGE_TICKS)
		cau_event_end_cut(h);
}

void cau_event_add(cau_hosted *h, int kind, const char *tool, const char *client, int64_t count,
                   const char *detail)
{
	if (kind == CAU_EVENT_CUT && h->cut_open) {
		newest(h)->count += count;
		return;
	}
	cau_event_end_cut(h);
	cau_wire_timeline_event *event = &h->events[h->event_count++ % EVENT_COUNT];
	*event = (cau_wire_timeline_event){.tick = (int64_t)h->tick,
	                                   .time_s = (double)h->tick * h->info.step_s,
	                                   .kind = kind,
	                                   .has_tool = tool && *tool,
	                                   .has_client = client && *client,
	                                   .has_count = count > 0,
	                                   .count = count,
	                                   .has_detail = detail && *detail};
	if (event->has_tool)
		snprintf(event->tool, sizeof event->tool, "%s", tool);
	if (event->has_client)
		snprintf(event->client, sizeof event->client, "%s", client);
	if (event->has_detail)
		snprintf(event->detail, sizeof event->detail, "%s", detail);
	if (kind == CAU_EVENT_CUT)
		h->cut_open = true;
	else
		publish(h, event);
}

// ---- from the store -----------------------------------------------------------------------------
typedef struct page {
	cau_wire_timeline_event *events; // newest first while it is read
	int32_t count, capacity;
} page;

// The store has the notification's text. What cannot be read is passed over.
static cau_status take_event(void *user, const cau_store_event *row)
{
	page *taken = user;
	cau_rpc_message message = {0};
	cau_rpc_fault fault;
	cau_wire_event_notice params = {0};
	size_t bytes = strlen(row->text);
	if (taken->count == taken->capacity || cau_rpc_read(row->text, bytes, bytes, &message, &fault))
		return CAU_OK;
	if (message.method == CAU_METHOD_EVENT && !cau_rpc_params(&message, &params, NULL))
		taken->events[taken->count++] = params.event;
	cau_rpc_finish(&message);
	return CAU_OK;
}

static cau_status read_page(cau_hosted *h, uint64_t from_tick, page *taken, cau_error *error)
{
	cau_status status = cau_store_read_timeline(h->around->store, h->id, h->branch, from_tick,
	                                            h->tick, taken->capacity, take_event, taken, error);
	for (int32_t i = 0; i < taken->count / 2; i++) {
		cau_wire_timeline_event swapped = taken->events[i];
		taken->events[i] = taken->events[taken->count - 1 - i];
		taken->events[taken->count - 1 - i] = swapped;
	}
	return status;
}

void cau_events_load(cau_hosted *h)
{
	cau_error error = {0};
	page taken = {h->events, 0, EVENT_COUNT};
	h->cut_open = false;
	if (read_page(h, 0, &taken, &error))
		cau_log(CAU_LOG_ERROR, h->id, "events_not_read", "reason=\"%s\"", error.reason);
	h->event_count = (uint64_t)taken.count;
	h->events_older = taken.count == EVENT_COUNT;
}

// ---- session.timeline ---------------------------------------------------------------------------
static bool in_memory(const cau_hosted *h, uint64_t from_tick, uint64_t wanted)
{
	uint64_t kept = h->event_count < EVENT_COUNT ? h->event_count : EVENT_COUNT;
	if (wanted <= kept || (!h->events_older && h->event_count <= EVENT_COUNT))
		return true;
	const cau_wire_timeline_event *oldest = &h->events[(h->event_count - kept) % EVENT_COUNT];
	return kept && (uint64_t)oldest->tick < from_tick;
}

static void copy_newest(const cau_hosted *h, uint64_t from_tick, page *taken)
{
	uint64_t wanted = (uint64_t)taken->capacity;
	uint64_t kept = h->event_count < EVENT_COUNT ? h->event_count : EVENT_COUNT;
	uint64_t from = h->event_count - (wanted < kept ? wanted : kept);
	for (uint64_t i = from; i < h->event_count; i++) {
		const cau_wire_timeline_event *event = &h->events[i % EVENT_COUNT];
		if ((uint64_t)event->tick >= from_tick)
			taken->events[taken->count++] = *event;
	}
}

static cau_status find_events(cau_hosted *h, uint64_t from_tick, page *taken, cau_error *error)
{
	if (in_memory(h, from_tick, (uint64_t)taken->capacity)) {
		copy_newest(h, from_tick, taken);
		return CAU_OK;
	}
	cau_event_end_cut(h);
	cau_record_commit(h);
	cau_store_flush(h->around->store);
	return read_page(h, from_tick, taken, error);
}

void cau_apply_timeline(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	int32_t wanted = order->as.timeline.count;
	page taken = {malloc((size_t)wanted * sizeof *taken.events), 0, wanted};
	cau_status status = taken.events
	                        ? find_events(h, order->as.timeline.from_tick, &taken, &error)
	                        : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the timeline");
	if (status) {
		cau_answer_fail(order, &error, 0);
	} else {
		cau_wire_timeline result = {.tick = (int64_t)h->tick,
		                            .oldest_tick = (int64_t)h->oldest_tick,
		                            .branch = h->branch,
		                            .events = {taken.events, taken.count, wanted}};
		cau_answer_order(h, order, &result);
	}
	free(taken.events);
}
