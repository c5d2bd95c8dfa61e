// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/timeline.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

#define READ_EXPECTED_S 0.02 // estimated time to read a page of the timeline from the store, s

static void tell(const cau_hosted_identity *identity, const cau_wire_timeline_event *what)
{
	cau_wire_event_notice params = {.event = *what};
	cau_audience audience = {CAU_AUDIENCE_SESSION, identity->number};
	snprintf(params.session, sizeof params.session, "%s", identity->id);
	cau_answer_notify(identity, audience, CAU_METHOD_EVENT, &params);
}

static void publish(cau_hosted_timeline *timeline, const cau_wire_timeline_event *event)
{
	bool trouble = event->kind == CAU_EVENT_WATCHDOG || event->kind == CAU_EVENT_FAULT ||
	               event->kind == CAU_EVENT_INVERTED || event->kind == CAU_EVENT_ENERGY_GAIN;
	cau_record_event(timeline->record, event, trouble ? CAU_LOG_WARNING : CAU_LOG_INFO);
	tell(timeline->record->identity, event);
}

// ---- cuts and tears -----------------------------------------------------------------------------
// Returns the event that may still grow. Cuts of neighbouring ticks are one event, and so are
// tears. Such an event is sent and stored once it is complete. One cut and one tear may grow at a
// time.
static cau_wire_timeline_event *event_at(cau_hosted_timeline *timeline, uint64_t open)
{
	return &timeline->events[(open - 1) % EVENT_COUNT];
}

static uint64_t *open_of(cau_hosted_timeline *timeline, int kind)
{
	return kind == CAU_EVENT_CUT    ? &timeline->cut_open
	       : kind == CAU_EVENT_TEAR ? &timeline->tear_open
	                                : NULL;
}

static void end_open(cau_hosted_timeline *timeline, uint64_t *open)
{
	uint64_t ended = *open;
	*open = 0;
	if (ended)
		publish(timeline, event_at(timeline, ended));
}

void cau_timeline_end_cuts(cau_hosted_timeline *timeline)
{
	bool cut_first = timeline->cut_open < timeline->tear_open;
	end_open(timeline, cut_first ? &timeline->cut_open : &timeline->tear_open);
	end_open(timeline, cut_first ? &timeline->tear_open : &timeline->cut_open);
}

void cau_timeline_settle(cau_hosted_timeline *timeline)
{
	uint64_t *const open[] = {&timeline->cut_open, &timeline->tear_open};
	for (int i = 0; i < 2; i++)
		if (*open[i] &&
		    timeline->core->tick > (uint64_t)event_at(timeline, *open[i])->tick + CUT_MERGE_TICKS)
			end_open(timeline, open[i]);
}

void cau_timeline_add(cau_hosted_timeline *timeline, int kind, const char *tool, const char *client,
                      int64_t count, const char *detail)
{
	CAU_ASSERT(timeline != NULL && timeline->core != NULL, "an event of kind %d without a session",
	           kind);
	uint64_t *open = open_of(timeline, kind);
	if (open && *open) {
		event_at(timeline, *open)->count += count;
		return;
	}
	if (!open)
		cau_timeline_end_cuts(timeline);
	cau_wire_timeline_event *event = &timeline->events[timeline->count++ % EVENT_COUNT];
	*event = (cau_wire_timeline_event){.tick = (int64_t)timeline->core->tick,
	                                   .time_s = (double)timeline->core->tick *
	                                             timeline->core->info.step_s,
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
	if (open)
		*open = timeline->count;
	else
		publish(timeline, event);
}

// ---- from the store -----------------------------------------------------------------------------
// Reads an event from a row, whose text is the notification. Unreadable rows are skipped.
static cau_status take_event(void *user, const cau_store_event *row)
{
	cau_timeline_page *taken = user;
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

cau_status cau_timeline_read(const cau_hosted_identity *identity, int64_t branch,
                             uint64_t from_tick, uint64_t to_tick, cau_timeline_page *taken,
                             cau_error *error)
{
	cau_status status =
		cau_store_read_timeline(identity->around->store, identity->id, branch, from_tick, to_tick,
	                            taken->capacity, take_event, taken, error);
	for (int32_t i = 0; i < taken->count / 2; i++) {
		cau_wire_timeline_event swapped = taken->events[i];
		taken->events[i] = taken->events[taken->count - 1 - i];
		taken->events[taken->count - 1 - i] = swapped;
	}
	return status;
}

void cau_timeline_load(cau_hosted_timeline *timeline)
{
	cau_error error = {0};
	cau_timeline_page taken = {timeline->events, 0, EVENT_COUNT};
	timeline->cut_open = timeline->tear_open = 0;
	if (cau_timeline_read(timeline->record->identity, timeline->record->history->branch, 0,
	                      timeline->core->tick, &taken, &error))
		cau_log(CAU_LOG_ERROR, timeline->record->identity->id, "events_not_read", "reason=\"%s\"",
		        error.reason);
	timeline->count = (uint64_t)taken.count;
	timeline->older = taken.count == EVENT_COUNT;
}

// ---- session.timeline: from memory, or from the store on the builder ----------------------------

static bool in_memory(const cau_hosted_timeline *timeline, uint64_t from_tick, uint64_t wanted)
{
	uint64_t kept = timeline->count < EVENT_COUNT ? timeline->count : EVENT_COUNT;
	if (wanted <= kept || (!timeline->older && timeline->count <= EVENT_COUNT))
		return true;
	const cau_wire_timeline_event *oldest =
		&timeline->events[(timeline->count - kept) % EVENT_COUNT];
	return kept && (uint64_t)oldest->tick < from_tick;
}

static void copy_newest(const cau_hosted_timeline *timeline, uint64_t from_tick,
                        cau_timeline_page *taken)
{
	uint64_t wanted = (uint64_t)taken->capacity;
	uint64_t kept = timeline->count < EVENT_COUNT ? timeline->count : EVENT_COUNT;
	uint64_t from = timeline->count - (wanted < kept ? wanted : kept);
	for (uint64_t i = from; i < timeline->count; i++) {
		const cau_wire_timeline_event *event = &timeline->events[i % EVENT_COUNT];
		if ((uint64_t)event->tick >= from_tick)
			taken->events[taken->count++] = *event;
	}
}

// Returns the tick from which on every tick can be reached. If the log has a gap that the store
// does not know yet, this is the present tick.
static uint64_t find_oldest_tick(const cau_read_job *job)
{
	cau_hosted *h = job->hosted;
	cau_error error = {0};
	uint64_t tick = job->tick;
	if (h->commits.lost_from == UINT64_MAX &&
	    cau_store_read_oldest_tick(h->identity.around->store, h->identity.id, job->branch, &tick,
	                               &error))
		cau_log(CAU_LOG_DEBUG, h->identity.id, "no_oldest_tick", "reason=\"%s\"", error.reason);
	return tick;
}

static void answer_page(const cau_read_job *job, cau_wire_timeline_event *events, int32_t count)
{
	cau_wire_timeline result = {.tick = (int64_t)job->tick,
	                            .oldest_tick = (int64_t)find_oldest_tick(job),
	                            .branch = job->branch,
	                            .events = {events, count, count}};
	cau_answer_now(&job->order->reply, &result);
}

// Answers with events that are no longer in memory. Runs on the builder.
static void answer_from_store(cau_read_job *job)
{
	cau_error error = {0};
	cau_timeline_page *taken = job->copy;
	cau_store_flush(job->hosted->identity.around->store);
	if (cau_timeline_read(&job->hosted->identity, job->branch, job->order->as.timeline.from_tick,
	                      job->tick, taken, &error))
		cau_reply_fail(&job->order->reply, &error, 0);
	else
		answer_page(job, taken->events, taken->count);
}

static void free_page(void *pointer)
{
	cau_timeline_page *taken = pointer;
	free(taken->events);
	free(taken);
}

static cau_timeline_page *make_page(int32_t capacity)
{
	cau_timeline_page *made = malloc(sizeof *made);
	if (made)
		*made = (cau_timeline_page){calloc((size_t)capacity, sizeof *made->events), 0, capacity};
	if (made && made->events)
		return made;
	free(made);
	return NULL;
}

void cau_apply_timeline(cau_hosted *h, cau_order *order)
{
	uint64_t from_tick = order->as.timeline.from_tick;
	cau_timeline_page *taken = make_page(order->as.timeline.count);
	if (!taken) {
		cau_answer_refuse(order, CAU_NO_MEMORY, "", "no memory for the timeline");
		return;
	}
	if (!in_memory(&h->timeline, from_tick, (uint64_t)taken->capacity)) {
		cau_timeline_end_cuts(&h->timeline);
		cau_reads_hand_over(h, order, answer_from_store, taken, free_page, READ_EXPECTED_S);
		return;
	}
	copy_newest(&h->timeline, from_tick, taken);
	cau_read_job now = {
		.hosted = h, .order = order, .tick = h->core.tick, .branch = h->history.branch};
	answer_page(&now, taken->events, taken->count);
	free_page(taken);
	free(order);
}
