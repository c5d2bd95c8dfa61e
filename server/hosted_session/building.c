// SPDX-License-Identifier: GPL-3.0-or-later
// How a session is built: away from the workers, by the builder, which has it for itself meanwhile.
// Its stages cannot be interrupted. At the borders between them it is told how far it is, what it
// will take is held against the settings, and who cancelled it is heard.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

// What building takes, for the builder's order, and what a step takes until the first is measured,
// s for each vertex: a sheet of 250,000 vertices is built in 10 s and steps in 0.12 s.
#define BUILT_VERTEX_S 4e-5
#define STEPPED_VERTEX_S 5e-7

enum { BYTES_OF_VERTEX = 100 }; // of a mesh file

#define MEGABYTE 1e6

static const char *const stage_names[] = {
#define X(code, name) [CAU_BUILD_##code] = (name),
	CAU_BUILD_STAGE_TABLE(X)
#undef X
};

// ---- what it takes
static double vertices_of(const cau_scene_def *scene)
{
	double count = 0;
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		const cau_mesh_def *mesh = &scene->meshes[i];
		double x = mesh->cells[0] + 1.0, y = mesh->cells[1] + 1.0, z = mesh->cells[2] + 1.0;
		if (mesh->source == CAU_MESH_SHEET)
			count += x * y;
		else if (mesh->source == CAU_MESH_SLAB)
			count += x * y * z;
		else
			count += (double)mesh->byte_count / BYTES_OF_VERTEX;
	}
	return count;
}

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
static bool is_destroyed(cau_hosted *h)
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

static cau_status check_wanted(cau_hosted *h, const char *next, cau_error *error)
{
	bool destroyed = is_destroyed(h);
	h->unwanted = destroyed || h->abandoned || h->drain_wanted;
	if (destroyed)
		return cau_fail(error, CAU_BAD_STATE, "",
		                "the session was destroyed while it was being built, before %s", next);
	if (h->abandoned)
		return cau_fail(error, CAU_BAD_STATE, "", "its creator is gone; it ended before %s", next);
	if (h->drain_wanted)
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending; it ended before %s", next);
	return CAU_OK;
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
	if (order->kind != CAU_ORDER_DESTROY || !h->away || !h->starting)
		return false;
	memcpy(name, order->asker.name, sizeof name); // the order may be answered before this returns
	bool taken = keep_cancelling(h, order);
	if (taken)
		cau_log(CAU_LOG_INFO, h->id, "cancelled",
		        "client=\"%s\" reason=\"it ends when its present stage does\"", name);
	return taken;
}

void cau_hosted_abandon(cau_hosted *h, uint32_t client)
{
	if (h->starting && h->origin.kind != CAU_ORIGIN_STORE && h->creator.client == client && client)
		h->abandoned = true;
}

// The session is gone: what the store has of it goes too, in the slice that ends with this.
static void answer_cancelled(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_wire_nothing result = {0};
	if (h->origin.kind == CAU_ORIGIN_STORE) {
		cau_store_batch *batch = cau_record_batch(h);
		if (!batch || cau_store_delete_session(batch, h->id, &error)) {
			cau_fail(&error, CAU_NO_MEMORY, "", "no memory to destroy it");
			cau_answer_fail(order, &error, 0);
			return;
		}
	}
	cau_answer_changed(h, CAU_CHANGE_DESTROYED, order->asker.name); // it was listed as starting
	cau_log(CAU_LOG_INFO, h->id, "destroyed", "client=\"%s\"", order->asker.name);
	cau_answer_order(h, order, &result);
}

// ---- the job
typedef struct building {
	cau_job job; // first
	cau_hosted *hosted;
} building;

// From here on it is the workers', and a session.destroy waits in the queue. Returns those that
// came before.
static cau_order *give_back(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	h->away = false;
	cau_order *cancelling = h->cancelling;
	h->cancelling = NULL;
	pthread_mutex_unlock(&h->mutex);
	return cancelling;
}

static bool is_resend(const cau_order *order, const cau_order *first)
{
	return order->client_sequence && order->client_sequence == first->client_sequence &&
	       strcmp(order->asker.client_id, first->asker.client_id) == 0;
}

// Sent twice while it was built: the answer is stored once.
static void answer_resend(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	size_t bytes = 0;
	char *text = cau_answer_text(order->reply.method, &(cau_wire_nothing){0}, &bytes, &error);
	if (text)
		cau_record_reply(h, &order->reply, text, bytes);
	else
		cau_reply_fail(&order->reply, &error, CAU_RPC_INTERNAL);
	free(order);
}

// The first destroyed it; to the others but its resends there is no such session any more.
static void answer_destroyers(cau_hosted *h)
{
	cau_order *first = h->destroyers;
	for (cau_order *order = first->next, *next; order; order = next) {
		next = order->next;
		if (is_resend(order, first))
			answer_resend(h, order);
		else
			cau_hosted_refuse_gone(order);
	}
	answer_cancelled(h, first);
	h->destroyers = NULL;
}

// No worker runs a session that has ended: its last slice is the builder's.
static void come_to_an_end(cau_hosted *h)
{
	if (is_destroyed(h))
		answer_destroyers(h);
	for (cau_order *late = give_back(h), *next; late; late = next) {
		next = late->next;
		cau_hosted_refuse_gone(late);
	}
	cau_hosted_end_slice(h);
}

static void come_back(cau_hosted *h)
{
	cau_error error = {0};
	if (h->starting) // the log is replayed in slices of the workers
		snprintf(h->stage, sizeof h->stage, "replaying");
	cau_hosted_end_slice(h);
	cau_worker_pool_expect(h->around->pool, &h->task, STEPPED_VERTEX_S * h->info.vertex_count);
	for (cau_order *late = give_back(h), *next; late; late = next) { // after the last border
		next = late->next;
		if (cau_hosted_submit(h, late, &error))
			cau_answer_fail(late, &error, 0);
	}
	cau_worker_pool_wake(h->around->pool, &h->task);
}

static void end(building *b)
{
	if (b->hosted->ended)
		come_to_an_end(b->hosted);
	else
		come_back(b->hosted);
	cau_hosted_release(b->hosted);
	free(b);
}

static void run(cau_job *job)
{
	building *b = (building *)job;
	cau_hosted_start(b->hosted);
	end(b);
}

static void drop(cau_job *job)
{
	building *b = (building *)job;
	cau_error error = {0};
	cau_fail(&error, CAU_BAD_STATE, "", "the daemon is ending");
	b->hosted->unwanted = true;
	cau_hosted_fail_start(b->hosted, &error);
	end(b);
}

cau_status cau_building_begin(cau_hosted *h, cau_error *error)
{
	building *b = malloc(sizeof *b);
	if (!b)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to build a session");
	*b = (building){
		.job = {.run = run, .drop = drop, .expected_s = BUILT_VERTEX_S * vertices_of(h->scene)},
		.hosted = cau_hosted_share(h)};
	cau_builder_submit(h->around->builder, &b->job);
	return CAU_OK;
}
