// SPDX-License-Identifier: GPL-3.0-or-later
// While the builder has a session, its stages cannot be interrupted. Between two stages the builder
// reports its progress, compares the session's memory with the limits, and checks whether clients
// have cancelled the session.
#include "hosted_session/life.h"

#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

static const char *const stage_names[] = {
#define X(code, name) [CAU_BUILD_##code] = (name),
	CAU_BUILD_STAGE_TABLE(X)
#undef X
};

void cau_suspension_name_stage(cau_hosted_suspension *suspension, const char *stage)
{
	snprintf(suspension->stage, sizeof suspension->stage, "%s", stage);
}

// ---- between the stages
static cau_order *take_cancelling(cau_hosted_suspension *suspension)
{
	pthread_mutex_lock(&suspension->lock);
	cau_order *taken = suspension->cancelling;
	suspension->cancelling = NULL;
	pthread_mutex_unlock(&suspension->lock);
	return taken;
}

// Returns false if the session is no longer suspended.
static bool keep_cancelling(cau_hosted_suspension *suspension, cau_order *order)
{
	pthread_mutex_lock(&suspension->lock);
	bool kept = suspension->active;
	if (kept)
		cau_order_append(&suspension->cancelling, order);
	pthread_mutex_unlock(&suspension->lock);
	return kept;
}

// Sorts the session.destroy orders that have come. A resend belongs to an earlier session of this
// name, and gets the earlier answer again.
bool cau_suspension_is_cancelled(cau_hosted *h)
{
	for (cau_order *order = take_cancelling(&h->suspension), *next; order; order = next) {
		next = order->next;
		cau_outcome_kind looked = cau_record_resend(h, order);
		// the order is a resend, and the earlier order is not on the disk yet
		if (looked == CAU_POSTPONED)
			keep_cancelling(&h->suspension, order);
		else if (looked == CAU_DONE)
			cau_order_append(&h->suspension.destroyers, order);
	}
	return h->suspension.destroyers != NULL;
}

cau_status cau_suspension_check(cau_hosted *h, const char *doing, const char *next,
                                cau_error *error)
{
	if (cau_suspension_is_cancelled(h))
		return cau_fail(error, CAU_BAD_STATE, "",
		                "the session was destroyed while it %s, before %s", doing, next);
	if (h->life.drain_wanted)
		return cau_fail(error, CAU_BAD_STATE, "",
		                "the daemon is ending; the session ended before %s", next);
	return CAU_OK;
}

static cau_status check_wanted(cau_hosted *h, const char *next, cau_error *error)
{
	cau_status status = cau_suspension_check(h, "was being built", next, error);
	if (!status && h->creation.abandoned)
		status = cau_fail(
			error, CAU_BAD_STATE, "",
			"the client that created the session disconnected; the session ended before %s", next);
	h->creation.unwanted = status != CAU_OK;
	return status;
}

static void tell_stage(cau_hosted *h, const char *stage, const cau_build_border *border)
{
	cau_suspension_name_stage(&h->suspension, stage);
	cau_hosted_publish_summary(h);
	cau_log(CAU_LOG_INFO, h->identity.id, "building",
	        "stage=%s vertices=%lld elements=%lld factor_entries=%lld megabytes=%.0f", stage,
	        (long long)border->vertex_count, (long long)border->element_count,
	        (long long)border->factor_entries, (double)border->bytes / 1e6);
}

cau_status cau_building_border(void *user, const cau_build_border *border, cau_error *error)
{
	cau_hosted *h = user;
	const char *next = stage_names[border->next];
	cau_status status = check_wanted(h, next, error);
	if (!status)
		status =
			cau_building_check_limits(h->identity.around, &h->creation.memory_held, border, error);
	if (!status)
		tell_stage(h, next, border);
	return status;
}

// ---- cancelling
bool cau_suspension_cancel(cau_hosted_suspension *suspension, const char *id, cau_order *order)
{
	char name[sizeof order->asker.name];
	if (order->kind != CAU_ORDER_DESTROY || !suspension->active)
		return false;
	// the order may be answered and freed before this returns
	memcpy(name, order->asker.name, sizeof name);
	bool taken = keep_cancelling(suspension, order);
	if (taken)
		cau_log(CAU_LOG_INFO, id, "cancelled",
		        "client=\"%s\" reason=\"the session ends after its present stage\"", name);
	return taken;
}

// ---- from a worker to the builder, and back
void cau_suspension_begin(cau_hosted_suspension *suspension, const cau_surroundings *around)
{
	cau_job *job = suspension->job;
	suspension->job = NULL;
	suspension->active = true;
	cau_builder_submit(suspension->holding ? around->mover : around->builder, job);
}

cau_order *cau_suspension_end(cau_hosted_suspension *suspension)
{
	pthread_mutex_lock(&suspension->lock);
	suspension->active = false;
	cau_order *cancelling = suspension->cancelling;
	suspension->cancelling = NULL;
	pthread_mutex_unlock(&suspension->lock);
	return cancelling;
}
