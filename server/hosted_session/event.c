// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, for the timeline, for everybody who watches, and for the store. The newest events
// of the present line are in memory; older ones are read from the store.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

#define READ_EXPECTED_S 0.02 // for a page of the timeline out of the store

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

// The newest on the branch's line from `from_tick` up to `to_tick`.
static cau_status read_page(const cau_hosted *h, int64_t branch, uint64_t from_tick,
                            uint64_t to_tick, page *taken, cau_error *error)
{
	cau_status status = cau_store_read_timeline(h->around->store, h->id, branch, from_tick, to_tick,
	                                            taken->capacity, take_event, taken, error);
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
	if (read_page(h, h->branch, 0, h->tick, &taken, &error))
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

// From where on every tick can be reached. What lies in a gap that the store does not know yet is
// not.
static uint64_t find_oldest_tick(const cau_read_job *job)
{
	cau_hosted *h = job->hosted;
	cau_error error = {0};
	uint64_t tick = job->tick;
	if (h->lost_from == UINT64_MAX &&
	    cau_store_read_oldest_tick(h->around->store, h->id, job->branch, &tick, &error))
		cau_log(CAU_LOG_DEBUG, h->id, "no_oldest_tick", "reason=\"%s\"", error.reason);
	return tick;
}

static void answer_page(const cau_read_job *job, cau_wire_timeline_event *events, int32_t count)
{
	const cau_reply *reply = &job->order->reply;
	cau_error error = {0};
	cau_outcome outcome = {0};
	cau_wire_timeline result = {.tick = (int64_t)job->tick,
	                            .oldest_tick = (int64_t)find_oldest_tick(job),
	                            .branch = job->branch,
	                            .events = {events, count, count}};
	char *text = cau_answer_text(reply->method, &result, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(reply, &outcome);
	free(text);
}

// On the builder: what memory does not hold any more.
static void answer_from_store(cau_read_job *job)
{
	cau_error error = {0};
	page *taken = job->copy;
	cau_store_flush(job->hosted->around->store);
	if (read_page(job->hosted, job->branch, job->order->as.timeline.from_tick, job->tick, taken,
	              &error))
		cau_reply_fail(&job->order->reply, &error, 0);
	else
		answer_page(job, taken->events, taken->count);
}

static void free_page(void *pointer)
{
	page *taken = pointer;
	free(taken->events);
	free(taken);
}

static page *make_page(int32_t capacity)
{
	page *made = malloc(sizeof *made);
	if (made)
		*made = (page){calloc((size_t)capacity, sizeof *made->events), 0, capacity};
	if (made && made->events)
		return made;
	free(made);
	return NULL;
}

void cau_apply_timeline(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	uint64_t from_tick = order->as.timeline.from_tick;
	page *taken = make_page(order->as.timeline.count);
	if (!taken) {
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the timeline");
		cau_answer_fail(order, &error, 0);
		return;
	}
	if (!in_memory(h, from_tick, (uint64_t)taken->capacity)) {
		cau_event_end_cut(h);
		cau_reads_hand_over(h, order, answer_from_store, taken, free_page, READ_EXPECTED_S);
		return;
	}
	copy_newest(h, from_tick, taken);
	cau_read_job now = {.hosted = h, .order = order, .tick = h->tick, .branch = h->branch};
	answer_page(&now, taken->events, taken->count);
	free_page(taken);
	free(order);
}
