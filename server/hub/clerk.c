// SPDX-License-Identifier: GPL-3.0-or-later
// Creates sessions on a worker, one after the other. For each request it first looks for a stored
// answer.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hosted_session/sink.h"
#include "hub/internal.h"

// Pause, s, before a resend is tried again while its earlier request is being handled.
#define AGAIN_S 0.02

void cau_creation_free(cau_creation *creation)
{
	free(creation->scene);
	free(creation->meshes);
	free(creation);
}

void cau_hub_submit_creation(cau_hub *hub, cau_creation *creation)
{
	creation->next = NULL;
	pthread_mutex_lock(&hub->clerk_mutex);
	if (hub->last)
		hub->last->next = creation;
	else
		hub->first = creation;
	hub->last = creation;
	pthread_mutex_unlock(&hub->clerk_mutex);
	cau_worker_pool_wake(hub->def.pool, &hub->clerk);
}

bool cau_hub_submit_missing(cau_hub *hub, const char *id, const cau_asker *asker,
                            int64_t client_sequence, const cau_reply *reply)
{
	bool sought = client_sequence || reply->method == CAU_METHOD_SESSION_DESTROY;
	cau_creation *creation = sought ? calloc(1, sizeof *creation) : NULL;
	if (!creation)
		return false;
	creation->kind = CAU_CREATION_MISSING;
	snprintf(creation->name, sizeof creation->name, "%s", id);
	creation->asker = *asker;
	creation->client_sequence = client_sequence;
	creation->reply = *reply;
	cau_hub_submit_creation(hub, creation);
	return true;
}

static cau_creation *take(cau_hub *hub)
{
	pthread_mutex_lock(&hub->clerk_mutex);
	cau_creation *creation = hub->first;
	if (creation)
		hub->first = creation->next;
	if (!hub->first)
		hub->last = NULL;
	pthread_mutex_unlock(&hub->clerk_mutex);
	return creation;
}

// Makes an id "label-name". If the name is empty, the id has the scene's name and a number.
static cau_status make_id(cau_hub *hub, const cau_creation *creation, char id[CAU_NAME_BYTES],
                          cau_error *error)
{
	char text[3 * CAU_NAME_BYTES];
	const char *label = hub->def.config->label;
	if (*creation->name)
		snprintf(text, sizeof text, "%.48s-%s", label, creation->name);
	else
		snprintf(text, sizeof text, "%.48s-%.30s-%u", label, creation->scene->name,
		         ++hub->last_name);
	if (strlen(text) >= CAU_NAME_BYTES)
		return cau_fail(error, CAU_BAD_VALUE, "params.name",
		                "the name with the label `%s-` is longer than %d bytes", label,
		                CAU_NAME_BYTES - 1);
	memcpy(id, text, strlen(text) + 1);
	return CAU_OK;
}

static cau_status check_place(cau_hub *hub, const cau_creation *creation, const char *id,
                              cau_error *error)
{
	cau_moved_to to;
	// The hub is asked about arrivals first: an arrival becomes one of the hub's sessions before it
	// ceases to be an arrival.
	bool arrives = creation->origin.kind != CAU_ORIGIN_STORE && cau_hub_arrives(hub, id);
	cau_hosted *other = cau_hub_find(hub, id);
	cau_hosted_release(other);
	if (other)
		return cau_fail(error, CAU_ALREADY_EXISTS, "params.name", "`%s` exists", id);
	if (creation->origin.kind != CAU_ORIGIN_STORE && cau_hub_moved(hub, id, &to))
		return cau_fail(error, CAU_ALREADY_EXISTS, "params.name",
		                "the session `%s` has moved and is now `%s`", id, to.session);
	if (arrives)
		return cau_fail(error, CAU_ALREADY_EXISTS, "params.name",
		                "the session `%s` is moving here from another daemon", id);
	if (cau_hub_count(hub) >= hub->def.config->max_sessions)
		return cau_fail(
			error, CAU_LIMIT, "",
			"the daemon has %lld sessions, which is the limit (setting max_sessions): destroy one",
			(long long)hub->def.config->max_sessions);
	return CAU_OK;
}

cau_status cau_clerk_make(cau_hub *hub, cau_creation *creation, const char *id, cau_error *error)
{
	cau_hosted *hosted = NULL;
	cau_status status = check_place(hub, creation, id, error);
	if (status)
		return status;
	cau_hosted_def def = cau_hub_define(hub, creation, id);
	def.creator = creation->asker;
	def.client_sequence = creation->client_sequence;
	def.reply = creation->reply;
	pthread_mutex_lock(&hub->mutex);
	bool room = (size_t)hub->session_count < SLOTS(hub->def.config);
	const cau_surroundings *around = creation->ephemeral ? &hub->around_ephemeral : &hub->around;
	status =
		room ? cau_hosted_create(&hosted, around, &def, error)
			 : cau_fail(error, CAU_LIMIT, "", "the store is still removing sessions: try again");
	if (!status) {
		hub->sessions[hub->session_count++] = hosted;
		creation->scene = NULL;
		creation->meshes = NULL;
	}
	pthread_mutex_unlock(&hub->mutex);
	return status;
}

static cau_status answer_again(void *user, const cau_store_answer *answer)
{
	const cau_creation *creation = user;
	cau_resend_answer(&creation->reply, answer->result.data, answer->result.bytes);
	return CAU_OK;
}

typedef struct being_made {
	const cau_creation *creation;
	bool found;
} being_made;

static void compare_maker(void *user, cau_hosted *hosted)
{
	being_made *search = user;
	if (cau_hosted_starting(hosted) && cau_hosted_made_by(hosted, search->creation->asker.client_id,
	                                                      search->creation->client_sequence))
		search->found = true;
}

// Looks for an earlier answer. Returns CAU_OK if it was sent from the store, and CAU_BAD_STATE if
// the earlier request is still being handled. CAU_ALREADY_EXISTS: the request was carried out, but
// its answer is no longer stored. Any other result: carry out the request.
static cau_status resent(cau_hub *hub, cau_creation *creation, cau_error *error)
{
	being_made search = {creation, false};
	if (!creation->client_sequence)
		return CAU_NOT_FOUND;
	cau_hub_each(hub, compare_maker, &search);
	if (search.found)
		return CAU_BAD_STATE;
	cau_store *store = creation->ephemeral ? hub->def.memory : hub->def.store;
	return cau_store_read_answer(store, creation->asker.client_id,
	                             (uint64_t)creation->client_sequence, answer_again, creation,
	                             error);
}

// Handles a request for a session that is not here. The request does not mean a session that was
// created after the request came.
static void act_on_missing(cau_hub *hub, const cau_creation *asked)
{
	bool destroys = asked->reply.method == CAU_METHOD_SESSION_DESTROY;
	// The hub is asked about arrivals before it is searched, as in check_place.
	bool arrives = destroys && cau_hub_arrives(hub, asked->name);
	cau_hosted *made = cau_hub_find(hub, asked->name);
	if (!made && destroys)
		cau_clerk_discard(hub, asked, arrives);
	else
		cau_clerk_answer_missing(hub, &asked->reply, asked->name);
	cau_hosted_release(made);
}

static void act(cau_hub *hub, cau_creation *creation)
{
	cau_error error = {0};
	char id[CAU_NAME_BYTES];
	cau_status status;
	if (creation->kind == CAU_CREATION_MISSING) {
		act_on_missing(hub, creation);
		return;
	}
	do
		status = make_id(hub, creation, id, &error);
	while (!status && (status = cau_clerk_make(hub, creation, id, &error)) == CAU_ALREADY_EXISTS &&
	       !*creation->name);
	if (status)
		cau_reply_fail(&creation->reply, &error, 0);
}

cau_due cau_clerk_run(cau_task *task)
{
	cau_hub *hub = (cau_hub *)((char *)task - offsetof(cau_hub, clerk));
	double now_s = cau_monotonic_s();
	cau_creation *creation = take(hub);
	if (!creation)
		return (cau_due){INFINITY, INFINITY, 0};
	cau_error error = {0};
	cau_status status = resent(hub, creation, &error);
	if (status == CAU_BAD_STATE) {
		cau_hub_submit_creation(hub, creation);
		return (cau_due){now_s + AGAIN_S, now_s + AGAIN_S, 0};
	}
	if (status == CAU_ALREADY_EXISTS) {
		snprintf(error.path, sizeof error.path, "params.client_sequence");
		cau_reply_fail(&creation->reply, &error, CAU_RPC_SEQUENCE_PAST);
	} else if (status != CAU_OK) {
		act(hub, creation);
	}
	cau_creation_free(creation);
	return (cau_due){0, now_s, 0};
}

// ---- forks
void cau_clerk_fork(void *user, cau_hosted *source, int64_t branch, const cau_order *order)
{
	cau_hub *hub = user;
	cau_error error = {0};
	cau_creation *creation = calloc(1, sizeof *creation);
	const cau_scene_def *scene = cau_hosted_scene(source);
	if (creation)
		creation->scene = malloc(sizeof *scene);
	if (!creation || !creation->scene) {
		free(creation);
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a fork");
		cau_reply_fail(&order->reply, &error, 0);
		return;
	}
	*creation->scene = *scene;
	memcpy(creation->name, order->as.fork.name, sizeof creation->name);
	creation->paused = order->as.fork.paused;
	// a fork is in the same store as its source
	creation->ephemeral = cau_hosted_is_ephemeral(source);
	creation->asker = order->asker;
	creation->client_sequence = order->client_sequence;
	creation->reply = order->reply;
	creation->origin =
		(cau_hosted_origin){.kind = CAU_ORIGIN_FORK, .branch = branch, .tick = order->as.fork.tick};
	snprintf(creation->origin.session, sizeof creation->origin.session, "%s",
	         cau_hosted_id(source));
	cau_status status =
		cau_meshes_pack(creation->scene, &creation->meshes, &creation->mesh_bytes, &error);
	if (status) {
		cau_reply_fail(&order->reply, &error, 0);
		cau_creation_free(creation);
		return;
	}
	cau_hub_submit_creation(hub, creation);
}
