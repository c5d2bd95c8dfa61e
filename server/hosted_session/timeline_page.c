// SPDX-License-Identifier: GPL-3.0-or-later
// session.timeline: a page of events out of memory, or by the builder out of the store.
#include <stdlib.h>

#include "hosted_session/answer.h"
#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

#define READ_EXPECTED_S 0.02 // for a page of the timeline out of the store

static bool in_memory(const cau_hosted *h, uint64_t from_tick, uint64_t wanted)
{
	uint64_t kept = h->timeline.count < EVENT_COUNT ? h->timeline.count : EVENT_COUNT;
	if (wanted <= kept || (!h->timeline.older && h->timeline.count <= EVENT_COUNT))
		return true;
	const cau_wire_timeline_event *oldest =
		&h->timeline.events[(h->timeline.count - kept) % EVENT_COUNT];
	return kept && (uint64_t)oldest->tick < from_tick;
}

static void copy_newest(const cau_hosted *h, uint64_t from_tick, cau_timeline_page *taken)
{
	uint64_t wanted = (uint64_t)taken->capacity;
	uint64_t kept = h->timeline.count < EVENT_COUNT ? h->timeline.count : EVENT_COUNT;
	uint64_t from = h->timeline.count - (wanted < kept ? wanted : kept);
	for (uint64_t i = from; i < h->timeline.count; i++) {
		const cau_wire_timeline_event *event = &h->timeline.events[i % EVENT_COUNT];
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
	if (h->commits.lost_from == UINT64_MAX &&
	    cau_store_read_oldest_tick(h->identity.around->store, h->identity.id, job->branch, &tick,
	                               &error))
		cau_log(CAU_LOG_DEBUG, h->identity.id, "no_oldest_tick", "reason=\"%s\"", error.reason);
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
	cau_error error = {0};
	uint64_t from_tick = order->as.timeline.from_tick;
	cau_timeline_page *taken = make_page(order->as.timeline.count);
	if (!taken) {
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the timeline");
		cau_answer_fail(order, &error, 0);
		return;
	}
	if (!in_memory(h, from_tick, (uint64_t)taken->capacity)) {
		cau_timeline_end_cuts(&h->timeline);
		cau_reads_hand_over(h, order, answer_from_store, taken, free_page, READ_EXPECTED_S);
		return;
	}
	copy_newest(h, from_tick, taken);
	cau_read_job now = {
		.hosted = h, .order = order, .tick = h->core.tick, .branch = h->history.branch};
	answer_page(&now, taken->events, taken->count);
	free_page(taken);
	free(order);
}
