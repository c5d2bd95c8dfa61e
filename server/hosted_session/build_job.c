// SPDX-License-Identifier: GPL-3.0-or-later
// Building a session as a job of the builder, and how it comes back to the workers or to an end.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

// What building takes, for the builder's order, and what a step takes until the first is measured,
// s for each vertex: a sheet of 250,000 vertices is built in 10 s and steps in 0.12 s.
#define BUILT_VERTEX_S 4e-5
#define STEPPED_VERTEX_S 5e-7

enum { BYTES_OF_VERTEX = 100 }; // of a mesh file

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
	if (cau_building_destroyed(h))
		answer_destroyers(h);
	for (cau_order *late = cau_building_give_back(h), *next; late; late = next) {
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
	for (cau_order *late = cau_building_give_back(h), *next; late;
	     late = next) { // after the last border
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
