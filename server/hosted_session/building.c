// SPDX-License-Identifier: GPL-3.0-or-later
// How a session is built: away from the workers, by the builder, which has it for itself meanwhile.
// Its stages cannot be interrupted. At the borders between them it is told how far it is, what it
// will take is held against the settings, and who cancelled it is heard.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

#define MEGABYTE 1e6

static const char *const stage_names[] = {
#define X(code, name) [CAU_BUILD_##code] = (name),
	CAU_BUILD_STAGE_TABLE(X)
#undef X
};

// ---- what it takes
static cau_status check_count(const char *what, int64_t count, int64_t most, const char *setting,
                              cau_error *error)
{
	if (count <= most)
		return CAU_OK;
	return cau_fail(error, CAU_LIMIT, "",
	                "the session has %lld %s; a session may have %lld "
	                "(setting %s)",
	                (long long)count, what, (long long)most, setting);
}

// Puts what the session will take in place of what was held for it before.
static cau_status hold_memory(cau_hosted *h, int64_t bytes, cau_error *error)
{
	const cau_config *config = h->around->config;
	if (bytes > config->max_session_bytes)
		return cau_fail(error, CAU_LIMIT, "",
		                "the session takes about %.0f MB of memory; a session may take %.0f MB "
		                "(setting max_session_bytes)",
		                (double)bytes / MEGABYTE, (double)config->max_session_bytes / MEGABYTE);
	int64_t more = bytes - h->memory_held;
	int64_t all = atomic_fetch_add(h->around->memory_held, more) + more;
	if (more > 0 && all > config->max_sessions_bytes) {
		atomic_fetch_sub(h->around->memory_held, more);
		return cau_fail(error, CAU_LIMIT, "",
		                "the session takes about %.0f MB of memory, all sessions then %.0f MB; "
		                "they may take %.0f MB (setting max_sessions_bytes)",
		                (double)bytes / MEGABYTE, (double)all / MEGABYTE,
		                (double)config->max_sessions_bytes / MEGABYTE);
	}
	h->memory_held = bytes;
	return CAU_OK;
}

cau_status cau_building_hold(cau_hosted *h, size_t more, cau_error *error)
{
	return hold_memory(h, h->memory_held + (int64_t)more, error);
}

static cau_status check_limits(cau_hosted *h, const cau_build_border *border, cau_error *error)
{
	const cau_config *config = h->around->config;
	cau_status status = check_count("vertices", border->vertex_count, config->max_session_vertices,
	                                "max_session_vertices", error);
	if (!status)
		status = check_count("elements", border->element_count, config->max_session_elements,
		                     "max_session_elements", error);
	return status ? status : hold_memory(h, (int64_t)border->bytes, error);
}

// ---- borders
static void append(cau_order **list, cau_order *order)
{
	while (*list)
		list = &(*list)->next;
	order->next = NULL;
	*list = order;
}

static cau_order *take_cancelling(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	cau_order *taken = h->cancelling;
	h->cancelling = NULL;
	pthread_mutex_unlock(&h->mutex);
	return taken;
}

// False: it is the workers' by now.
static bool keep_cancelling(cau_hosted *h, cau_order *order)
{
	pthread_mutex_lock(&h->mutex);
	bool kept = h->away;
	if (kept)
		append(&h->cancelling, order);
	pthread_mutex_unlock(&h->mutex);
	return kept;
}

// Whether somebody destroys it. An order that was sent before destroyed another session of this
// name, and gets its answer again.
bool cau_building_destroyed(cau_hosted *h)
{
	for (cau_order *order = take_cancelling(h), *next; order; order = next) {
		next = order->next;
		cau_outcome_kind looked = cau_hosted_look(h, order);
		if (looked == CAU_POSTPONED) // its first is not on the disk yet
			keep_cancelling(h, order);
		else if (looked == CAU_DONE)
			append(&h->destroyers, order);
	}
	return h->destroyers != NULL;
}

cau_status cau_building_check(cau_hosted *h, const char *doing, const char *next, cau_error *error)
{
	if (cau_building_destroyed(h))
		return cau_fail(error, CAU_BAD_STATE, "",
		                "the session was destroyed while it %s, before %s", doing, next);
	if (h->drain_wanted)
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending; it ended before %s", next);
	return CAU_OK;
}

static cau_status check_wanted(cau_hosted *h, const char *next, cau_error *error)
{
	cau_status status = cau_building_check(h, "was being built", next, error);
	if (!status && h->abandoned)
		status = cau_fail(error, CAU_BAD_STATE, "", "its creator disconnected; it ended before %s",
		                  next);
	h->unwanted = status != CAU_OK;
	return status;
}

static void tell_stage(cau_hosted *h, const char *stage, const cau_build_border *border)
{
	snprintf(h->stage, sizeof h->stage, "%s", stage);
	cau_hosted_publish_summary(h);
	cau_log(CAU_LOG_INFO, h->id, "building",
	        "stage=%s vertices=%lld elements=%lld factor_entries=%lld megabytes=%.0f", stage,
	        (long long)border->vertex_count, (long long)border->element_count,
	        (long long)border->factor_entries, (double)border->bytes / MEGABYTE);
}

cau_status cau_building_border(void *user, const cau_build_border *border, cau_error *error)
{
	cau_hosted *h = user;
	const char *next = stage_names[border->next];
	cau_status status = check_wanted(h, next, error);
	if (!status)
		status = check_limits(h, border, error);
	if (!status)
		tell_stage(h, next, border);
	return status;
}

// ---- cancelling
bool cau_building_cancel(cau_hosted *h, cau_order *order)
{
	char name[sizeof order->asker.name];
	if (order->kind != CAU_ORDER_DESTROY || !h->away)
		return false;
	memcpy(name, order->asker.name, sizeof name); // the order may be answered before this returns
	bool taken = keep_cancelling(h, order);
	if (taken)
		cau_log(CAU_LOG_INFO, h->id, "cancelled",
		        "client=\"%s\" reason=\"it ends when its present stage does\"", name);
	return taken;
}

// From here on it is the workers', and a session.destroy waits in the queue. Returns those that
// came before.
cau_order *cau_building_give_back(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	h->away = false;
	cau_order *cancelling = h->cancelling;
	h->cancelling = NULL;
	pthread_mutex_unlock(&h->mutex);
	return cancelling;
}
