// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, for the timeline, for everybody who watches, and for the store.
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

void cau_event_add(cau_hosted *h, int kind, const char *tool, const char *client, int64_t count,
                   const char *detail)
{
	cau_wire_timeline_event *last = newest(h);
	if (kind == CAU_EVENT_CUT && last && last->kind == CAU_EVENT_CUT &&
	    h->tick <= (uint64_t)last->tick + CUT_MERGE_TICKS) {
		last->count += count;
		return;
	}
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
	cau_record_event(h, event,
	                 kind == CAU_EVENT_WATCHDOG || kind == CAU_EVENT_FAULT ? CAU_LOG_WARNING
	                                                                       : CAU_LOG_INFO);
	tell(h, event);
}

void cau_apply_timeline(cau_hosted *h, cau_order *order)
{
	cau_wire_timeline_event *chosen = malloc(EVENT_COUNT * sizeof *chosen);
	cau_wire_timeline result = {.tick = (int64_t)h->tick,
	                            .oldest_tick = (int64_t)h->oldest_tick,
	                            .branch = h->branch,
	                            .events = {chosen, 0, EVENT_COUNT}};
	if (!chosen) {
		cau_error error = {.status = CAU_NO_MEMORY, .reason = "no memory for the timeline"};
		cau_answer_fail(order, &error, 0);
		return;
	}
	uint64_t wanted = (uint64_t)order->as.timeline.count;
	uint64_t kept = h->event_count < EVENT_COUNT ? h->event_count : EVENT_COUNT;
	uint64_t from = h->event_count - (wanted < kept ? wanted : kept);
	for (uint64_t i = from; i < h->event_count; i++) {
		const cau_wire_timeline_event *event = &h->events[i % EVENT_COUNT];
		if ((uint64_t)event->tick >= order->as.timeline.from_tick)
			chosen[result.events.count++] = *event;
	}
	cau_answer_order(h, order, &result);
	free(chosen);
}
