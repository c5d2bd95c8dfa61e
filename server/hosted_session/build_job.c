// SPDX-License-Identifier: GPL-3.0-or-later
// Building a session as a job of the builder, and how it comes back to the workers or to an end.
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cautery/assert.h"
#include "hosted_session/internal.h"

// What building takes, for the builder's order, and what a step takes until the first is measured,
// s for each vertex: a sheet of 250,000 vertices is built in 10 s and steps in 0.12 s.
#define BUILT_VERTEX_S 4e-5
#define STEPPED_VERTEX_S 5e-7

enum { BYTES_OF_VERTEX = 100 }; // of a mesh file

// Where the core will read it: core/mesh/mesh_make.c. One that is not there ends the building soon.
static double bytes_of_file(const char *directory, const char *file)
{
	char path[600];
	struct stat status;
	bool alone = *file == '/' || !*directory;
	int length =
		snprintf(path, sizeof path, "%s%s%s", alone ? "" : directory, alone ? "" : "/", file);
	bool there = length < (int)sizeof path && stat(path, &status) == 0;
	return there ? (double)status.st_size : 0;
}

static double vertices_of(const cau_scene_def *scene, const cau_mesh_def *mesh)
{
	double x = mesh->cells[0] + 1.0, y = mesh->cells[1] + 1.0, z = mesh->cells[2] + 1.0;
	switch (mesh->source) {
	case CAU_MESH_SHEET:
	case CAU_MESH_PATTERN:
		return x * y;
	case CAU_MESH_SLAB:
		return x * y * z;
	case CAU_MESH_FILE:
		return bytes_of_file(scene->directory, mesh->file) / BYTES_OF_VERTEX;
	default:
		return (double)mesh->byte_count / BYTES_OF_VERTEX;
	}
}

double cau_building_expects_s(const cau_scene_def *scene)
{
	double vertices = 0;
	for (int32_t i = 0; i < scene->mesh_count; i++)
		vertices += vertices_of(scene, &scene->meshes[i]);
	return BUILT_VERTEX_S * vertices;
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
			cau_hosted_refuse_gone(h, order);
	}
	cau_hosted_destroy(h, first, h->origin.kind == CAU_ORIGIN_STORE || !h->unanswered);
	h->destroyers = NULL;
}

// Its last slice is the builder's. What a resend is looked for in must be on the disk by then:
// there is no border any more at which it could be looked for again.
static void come_to_an_end(cau_hosted *h)
{
	cau_store_flush(h->around->store);
	if (!*h->moved.session && cau_building_destroyed(h)) // else it is destroyed where it is now
		answer_destroyers(h);
	cau_hosted_refuse_rest(h);
	cau_hosted_end_slice(h);
	for (cau_order *late = cau_building_give_back(h), *next; late; late = next) {
		next = late->next;
		cau_hosted_refuse_gone(h, late);
	}
}

static void come_back(cau_hosted *h)
{
	cau_error error = {0};
	cau_hosted_end_slice(h);
	for (cau_order *late = cau_building_give_back(h), *next; late;
	     late = next) { // after the last border
		next = late->next;
		if (cau_hosted_submit(h, late, &error))
			cau_answer_fail(late, &error, 0);
	}
	cau_worker_pool_wake(h->around->pool, &h->task);
}

void cau_building_over(cau_hosted *h)
{
	if (h->ended)
		come_to_an_end(h);
	else
		come_back(h);
}

static void end(building *b)
{
	cau_hosted *h = b->hosted;
	if (h->replaying) // in slices of the workers
		snprintf(h->stage, sizeof h->stage, "replaying");
	h->piece_s = STEPPED_VERTEX_S * h->info.vertex_count;
	cau_building_over(h);
	cau_hosted_release(h);
	free(b);
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

// ---- of a move: it is built and waits to be accepted
// ---------------------------------------------

static void wait_to_come(building *b)
{
	cau_hosted *h = b->hosted;
	cau_error error = {0};
	cau_outcome outcome = {0};
	cau_wire_move_held result = {.tick = (int64_t)h->replay.tick,
	                             .hash = cau_session_hash(h->core),
	                             .has_exact = true,
	                             .exact = h->replay.exact};
	cau_reply reply;
	char *text = cau_answer_text(h->creator_reply.method, &result, &outcome.text_bytes, &error);
	if (!text) {
		drop(&b->job);
		return;
	}
	cau_replay_finish(&h->replay);
	bool waits = cau_hosted_take_creator(h, &reply);
	h->built = &b->job;
	outcome.text = text;
	if (waits)
		cau_reply_answer(&reply, &outcome); // from here on it may come
	free(text);
}

static void run_again(cau_job *job)
{
	building *b = (building *)job;
	cau_hosted_resume(b->hosted);
	end(b);
}

static void leave_to_builder(cau_hosted *h, void (*run)(cau_job *job))
{
	cau_job *job = h->built;
	CAU_ASSERT(job != NULL, "session %s waits for nothing", h->id);
	h->built = NULL;
	job->run = run;
	cau_builder_submit(h->around->mover, job);
}

void cau_hosted_come(cau_hosted *h, int64_t branch, bool paused, const cau_reply *reply)
{
	h->incoming = false;
	h->came = true;
	h->origin.branch = branch;
	h->pause_at_start = paused;
	h->creator_reply = *reply;
	h->creator_waits = true;
	leave_to_builder(h, run_again);
}

void cau_hosted_give_up(cau_hosted *h)
{
	leave_to_builder(h, drop);
}

static void run(cau_job *job)
{
	building *b = (building *)job;
	cau_hosted_start(b->hosted);
	if (b->hosted->incoming && !b->hosted->ended)
		wait_to_come(b);
	else
		end(b);
}

cau_status cau_building_begin(cau_hosted *h, cau_error *error)
{
	building *b = malloc(sizeof *b);
	if (!b)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to build a session");
	*b = (building){
		.job = {.run = run, .drop = drop, .expected_s = cau_building_expects_s(h->scene)},
		.hosted = cau_hosted_share(h)};
	cau_builder_submit(h->around->builder, &b->job);
	return CAU_OK;
}
