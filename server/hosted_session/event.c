// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, for the timeline, for everybody who watches, and for the store. The newest events
// of the present line are in memory; older ones are read from the store.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

static void tell(cau_hosted *h, const cau_wire_timeline_event *what)
{
	cau_wire_event_notice params = {.event = *what};
	cau_audience audience = {CAU_AUDIENCE_SESSION, h->number};
	snprintf(params.session, sizeof params.session, "%s", h->id);
	cau_answer_notify(h, audience, CAU_METHOD_EVENT, &params);
}

static void publish(cau_hosted *h, const cau_wire_timeline_event *event)
{
	bool trouble = event->kind == CAU_EVENT_WATCHDOG || event->kind == CAU_EVENT_FAULT ||
	               event->kind == CAU_EVENT_INVERTED || event->kind == CAU_EVENT_ENERGY_GAIN;
	cau_record_event(h, event, trouble ? CAU_LOG_WARNING : CAU_LOG_INFO);
	tell(h, event);
}

void cau_event_know_tissue(cau_hosted *h)
{
	cau_frame frame;
	cau_session_frame(h->core, &frame);
	h->elements_removed = frame.statistics.elements_removed;
	h->elements_torn = frame.statistics.elements_torn;
	for (int32_t i = 0; i < frame.vessel_count; i++)
		h->vessel_flags[i] = frame.vessels[i]->flags;
}

// ---- cuts and tears -----------------------------------------------------------------------------
// Those of neighbouring ticks are one event, which is told and stored once it is whole. One of each
// may grow at a time.
static cau_wire_timeline_event *event_at(cau_hosted *h, uint64_t open)
{
	return &h->events[(open - 1) % EVENT_COUNT];
}

static uint64_t *open_of(cau_hosted *h, int kind)
{
	return kind == CAU_EVENT_CUT ? &h->cut_open : kind == CAU_EVENT_TEAR ? &h->tear_open : NULL;
}

static void end_open(cau_hosted *h, uint64_t *open)
{
	uint64_t ended = *open;
	*open = 0;
	if (ended)
		publish(h, event_at(h, ended));
}

void cau_event_end_cut(cau_hosted *h)
{
	bool cut_first = h->cut_open < h->tear_open;
	end_open(h, cut_first ? &h->cut_open : &h->tear_open);
	end_open(h, cut_first ? &h->tear_open : &h->cut_open);
}

void cau_event_settle(cau_hosted *h)
{
	uint64_t *const open[] = {&h->cut_open, &h->tear_open};
	for (int i = 0; i < 2; i++)
		if (*open[i] && h->tick > (uint64_t)event_at(h, *open[i])->tick + CUT_MERGE_TICKS)
			end_open(h, open[i]);
}

void cau_event_add(cau_hosted *h, int kind, const char *tool, const char *client, int64_t count,
                   const char *detail)
{
	uint64_t *open = open_of(h, kind);
	if (open && *open) {
		event_at(h, *open)->count += count;
		return;
	}
	if (!open)
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
	if (open)
		*open = h->event_count;
	else
		publish(h, event);
}

// ---- from the store -----------------------------------------------------------------------------
// The store has the notification's text. What cannot be read is passed over.
static cau_status take_event(void *user, const cau_store_event *row)
{
	cau_event_page *taken = user;
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

cau_status cau_events_read(const cau_hosted *h, int64_t branch, uint64_t from_tick,
                           uint64_t to_tick, cau_event_page *taken, cau_error *error)
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
	cau_event_page taken = {h->events, 0, EVENT_COUNT};
	h->cut_open = h->tear_open = 0;
	if (cau_events_read(h, h->branch, 0, h->tick, &taken, &error))
		cau_log(CAU_LOG_ERROR, h->id, "events_not_read", "reason=\"%s\"", error.reason);
	h->event_count = (uint64_t)taken.count;
	h->events_older = taken.count == EVENT_COUNT;
}

// ---- faults -------------------------------------------------------------------------------------
void cau_hosted_tell_fault(cau_hosted *h, const cau_error *error)
{
	cau_wire_session_faulted params = {.tick = (int64_t)h->tick};
	snprintf(params.session, sizeof params.session, "%s", h->id);
	snprintf(params.reason, sizeof params.reason, "%.319s", error->reason);
	cau_event_add(h, CAU_EVENT_FAULT, NULL, NULL, 0, error->reason);
	cau_answer_notify(h, (cau_audience){CAU_AUDIENCE_SESSION, h->number},
	                  CAU_METHOD_SESSION_FAULTED, &params);
	h->dirty = true;
}

void cau_hosted_fault(cau_hosted *h, const cau_error *error)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_FAULT,
	                                 .time_s = cau_monotonic_s(),
	                                 .cause = error->reason});
	h->realtime_factor = 0; // it stands still, as a paused one does
	cau_hosted_tell_fault(h, error);
}
