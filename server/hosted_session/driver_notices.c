// SPDX-License-Identifier: GPL-3.0-or-later
// Notifies clients of drivers, energy and refused motion.
#include <string.h>

#include "hosted_session/hosted.h"
#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

enum { REFUSALS_TOLD_EVERY_S = 1 };

void cau_driver_notify(const cau_hosted_identity *identity, const cau_drive *drive)
{
	cau_wire_driver_changed params = {0};
	cau_audience audience = {CAU_AUDIENCE_SESSION, identity->number};
	snprintf(params.session, sizeof params.session, "%s", identity->id);
	cau_answer_driver(drive, &params.driver);
	cau_answer_notify(identity, audience, CAU_METHOD_TOOL_DRIVER_CHANGED, &params);
}

// ---- refused motion -----------------------------------------------------------------------------

// Returns the entry of this tool or an unused entry, NULL if other tools use all entries. Call this
// under the lock.
static cau_refused_motion *find_place(cau_hosted_refusals *refusals, const char *tool)
{
	cau_refused_motion *unused = NULL;
	for (int32_t i = 0; i < CAU_MAX_TOOLS; i++) {
		cau_refused_motion *place = &refusals->place[i];
		if (strcmp(place->tool, tool) == 0)
			return place;
		if (!place->count)
			unused = place;
	}
	return unused;
}

void cau_refusals_note(cau_hosted_refusals *refusals, const cau_order *order,
                       const cau_error *error)
{
	pthread_mutex_lock(&refusals->lock);
	refusals->count++;
	cau_refused_motion *place = find_place(refusals, order->as.command.tool);
	if (place) {
		if (strcmp(place->tool, order->as.command.tool) != 0)
			place->told_s = 0;
		snprintf(place->tool, sizeof place->tool, "%s", order->as.command.tool);
		place->count++;
		place->client = order->asker.client;
		place->sequence = order->as.command.sequence;
		place->error = *error;
	}
	pthread_mutex_unlock(&refusals->lock);
}

static void report(const cau_hosted_identity *identity, const cau_refused_motion *told)
{
	cau_wire_tool_refused params = {.count = told->count,
	                                .sequence = (int64_t)told->sequence,
	                                .has_path = *told->error.path != 0};
	snprintf(params.session, sizeof params.session, "%s", identity->id);
	memcpy(params.tool, told->tool, sizeof params.tool);
	snprintf(params.status, sizeof params.status, "%s", cau_status_name(told->error.status));
	snprintf(params.path, sizeof params.path, "%s", told->error.path);
	snprintf(params.reason, sizeof params.reason, "%.319s", told->error.reason);
	cau_answer_notify(identity, (cau_audience){CAU_AUDIENCE_CLIENT, told->client},
	                  CAU_METHOD_TOOL_REFUSED, &params);
}

void cau_refusals_report(cau_hosted_refusals *refusals, const cau_hosted_identity *identity,
                         double now_s)
{
	for (int32_t i = 0; i < CAU_MAX_TOOLS; i++) {
		cau_refused_motion *place = &refusals->place[i];
		pthread_mutex_lock(&refusals->lock);
		cau_refused_motion told = *place;
		bool due = told.count && now_s - told.told_s >= REFUSALS_TOLD_EVERY_S;
		if (due) {
			place->count = 0;
			place->told_s = now_s;
		}
		pthread_mutex_unlock(&refusals->lock);
		if (due)
			report(identity, &told);
	}
}

// ---- motion that transports refused -------------------------------------------------------------

void cau_hosted_refuse(cau_hosted *h, const char *tool, const cau_asker *asker, uint64_t sequence,
                       const cau_error *error)
{
	cau_order order = {.motion = true, .asker = *asker};
	snprintf(order.as.command.tool, sizeof order.as.command.tool, "%s", tool);
	order.as.command.sequence = sequence;
	cau_refusals_note(&h->refusals, &order, error);
}

void cau_hosted_count_refused(cau_hosted *h, uint64_t count)
{
	pthread_mutex_lock(&h->refusals.lock);
	h->refusals.count += count;
	pthread_mutex_unlock(&h->refusals.lock);
}
