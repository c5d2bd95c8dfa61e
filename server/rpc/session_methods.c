// SPDX-License-Identifier: GPL-3.0-or-later
// The methods about sessions, and about the store that keeps them.
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

enum { TIMELINE_COUNT = 1024 }; // events in an answer if the request gives no count

// ---- session.list
// Makes space for one more item. Sessions may be created during the listing, so a count taken
// before would not be enough.
static bool make_room(cau_wire_list *list)
{
	enum { FIRST_PLACES = 16 };
	if (list->count < list->capacity)
		return true;
	int32_t capacity = list->capacity ? 2 * list->capacity : FIRST_PLACES;
	void *grown = realloc(list->items, (size_t)capacity * sizeof(cau_wire_session_summary));
	if (!grown)
		return false;
	list->items = grown;
	list->capacity = capacity;
	return true;
}

typedef struct listing {
	cau_wire_list list;
	bool failed; // memory ran out
} listing;

static void list_one(void *user, cau_hosted *hosted)
{
	listing *l = user;
	l->failed = l->failed || !make_room(&l->list);
	if (!l->failed)
		cau_hosted_summary(hosted, (cau_wire_session_summary *)l->list.items + l->list.count++);
}

static int by_id(const void *a, const void *b)
{
	return strcmp(((const cau_wire_session_summary *)a)->session,
	              ((const cau_wire_session_summary *)b)->session);
}

// Removes the sessions for which the connection's token is not valid.
static void keep_allowed(const cau_peer *peer, cau_wire_list *list)
{
	cau_wire_session_summary *summary = list->items;
	int32_t kept = 0;
	for (int32_t i = 0; i < list->count; i++)
		if (cau_auth_session_allowed(&peer->bounds, summary[i].session))
			summary[kept++] = summary[i];
	list->count = kept;
}

void cau_call_session_list(cau_call *call)
{
	cau_error error = {.status = CAU_NO_MEMORY};
	listing l = {.failed = false};
	cau_hub_each(call->peer->service->hub, list_one, &l);
	if (l.failed) {
		cau_call_fail(call, &error, 0);
	} else {
		keep_allowed(call->peer, &l.list);
		if (l.list.count)
			qsort(l.list.items, (size_t)l.list.count, sizeof(cau_wire_session_summary), by_id);
		cau_call_result(call, &(cau_wire_session_list){.sessions = l.list});
	}
	free(l.list.items);
}

// ---- session.create
static cau_status choose_scene(cau_peer *peer, const cau_wire_session_create *params,
                               cau_scene_def *scene, cau_error *error)
{
	cau_scenes *scenes = cau_hub_scenes(peer->service->hub);
	if (params->has_scene == params->has_definition)
		return cau_fail(error, CAU_BAD_VALUE, "params.scene",
		                "give either scene or definition, and not both");
	if (params->has_scene) {
		if (cau_scenes_copy(scenes, params->scene, scene))
			return CAU_OK;
		return cau_fail(error, CAU_NOT_FOUND, "params.scene", "there is no scene `%.48s`",
		                params->scene);
	}
	for (int32_t i = 0; i < scene->mesh_count; i++)
		if (scene->meshes[i].source == CAU_MESH_FILE)
			return cau_fail(error, CAU_UNSUPPORTED, "params.definition.meshes",
			                "only scenes of the daemon may name mesh files on its disk: upload the "
			                "mesh instead");
	return cau_peer_fill_meshes(peer, scene, error);
}

static cau_status read_creation(cau_call *call, cau_creation *creation, cau_error *error)
{
	cau_wire_session_create params = {0};
	params.definition = creation->scene;
	cau_status status = cau_rpc_params(call->message, &params, error);
	if (!status)
		status = choose_scene(call->peer, &params, creation->scene, error);
	if (!status)
		status = cau_meshes_pack(creation->scene, &creation->meshes, &creation->mesh_bytes, error);
	if (status)
		return status;
	memcpy(creation->name, params.name, sizeof creation->name);
	creation->paused = params.paused;
	creation->ephemeral = params.ephemeral;
	creation->client_sequence = params.client_sequence;
	creation->asker = call->peer->client.asker;
	creation->reply = cau_call_reply(call);
	return CAU_OK;
}

void cau_call_session_create(cau_call *call)
{
	cau_error error = {0};
	cau_creation *creation = calloc(1, sizeof *creation);
	if (creation)
		creation->scene = calloc(1, sizeof *creation->scene);
	cau_status status = creation && creation->scene
	                        ? read_creation(call, creation, &error)
	                        : cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a scene");
	cau_store_health health;
	cau_store_get_health(call->peer->service->store, &health);
	bool full = health.state != CAU_STORE_READY && !(creation && creation->ephemeral);
	if (!status && full)
		status = cau_fail(&error, CAU_IO, "", "%s", health.reason);
	// if not allowed, the call is already answered
	bool allowed = status || cau_call_may_make(call, creation->name);
	if (!status && allowed) {
		cau_hub_submit_creation(call->peer->service->hub, creation);
		return;
	}
	if (status)
		cau_call_fail(call, &error, full && status == CAU_IO ? CAU_RPC_STORE_FULL : 0);
	if (creation) {
		free(creation->meshes);
		free(creation->scene);
	}
	free(creation);
}

// ---- methods that are one order of the session
static void submit(const cau_call *call, cau_order *order)
{
	if (order)
		cau_call_submit(call, order);
}

// Submits an order whose params are `session` and perhaps `client_sequence`; both are in the
// envelope.
static void submit_plain(const cau_call *call, cau_order_kind kind)
{
	union {
		cau_wire_session_ref ref;
		cau_wire_session_change change;
	} params = {0};
	submit(call, cau_call_order_with(call, kind, &params));
}

void cau_call_session_describe(cau_call *call)
{
	submit_plain(call, CAU_ORDER_DESCRIBE);
}

void cau_call_session_pause(cau_call *call)
{
	submit_plain(call, CAU_ORDER_PAUSE);
}

void cau_call_session_resume(cau_call *call)
{
	submit_plain(call, CAU_ORDER_RESUME);
}

void cau_call_session_reset(cau_call *call)
{
	submit_plain(call, CAU_ORDER_RESET);
}

void cau_call_session_destroy(cau_call *call)
{
	submit_plain(call, CAU_ORDER_DESTROY);
}

void cau_call_session_step(cau_call *call)
{
	cau_wire_session_step params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_STEP, &params);
	if (order)
		order->as.ticks = params.has_ticks ? params.ticks : 1;
	submit(call, order);
}

void cau_call_session_speed(cau_call *call)
{
	cau_wire_session_speed params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_SPEED, &params);
	if (order)
		order->as.speed = params.speed;
	submit(call, order);
}

void cau_call_session_rewind(cau_call *call)
{
	cau_wire_session_rewind params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_REWIND, &params);
	if (order)
		order->as.tick = (uint64_t)params.tick;
	submit(call, order);
}

void cau_call_session_snapshot(cau_call *call)
{
	cau_wire_session_snapshot params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_SNAPSHOT, &params);
	if (order)
		memcpy(order->as.name, params.name, sizeof order->as.name);
	submit(call, order);
}

void cau_call_session_snapshots(cau_call *call)
{
	submit_plain(call, CAU_ORDER_SNAPSHOTS);
}

void cau_call_session_restore(cau_call *call)
{
	cau_wire_session_restore params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_RESTORE, &params);
	if (order)
		memcpy(order->as.name, params.name, sizeof order->as.name);
	submit(call, order);
}

void cau_call_session_fork(cau_call *call)
{
	cau_wire_session_fork params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_FORK, &params);
	if (order) {
		memcpy(order->as.fork.name, params.name, sizeof order->as.fork.name);
		order->as.fork.has_tick = params.has_tick;
		order->as.fork.tick = (uint64_t)params.tick;
		order->as.fork.paused = params.paused;
	}
	if (order && !cau_call_may_make(call, params.name)) {
		free(order);
		return;
	}
	submit(call, order);
}

void cau_call_session_waiting(cau_call *call)
{
	cau_error error = {0};
	cau_wire_session_ref params = {0};
	int32_t capacity = (int32_t)call->peer->service->config->queue_commands;
	cau_wire_waiting_list result = {
		.commands = {calloc((size_t)capacity, sizeof(cau_wire_waiting_command)), 0, capacity}};
	cau_hosted *hosted = cau_call_session(call);
	if (!hosted) {
		free(result.commands.items);
		return;
	}
	if (!result.commands.items)
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the list");
	else if (!cau_rpc_params(call->message, &params, &error))
		result.commands.count = cau_hosted_waiting(hosted, result.commands.items, capacity);
	if (error.status)
		cau_call_fail(call, &error, 0);
	else
		cau_call_result(call, &result);
	cau_hosted_release(hosted);
	free(result.commands.items);
}

void cau_call_session_cancel(cau_call *call)
{
	cau_error error = {0};
	cau_wire_session_cancel params = {0};
	cau_wire_cancelled result = {0};
	const cau_asker *asker = &call->peer->client.asker;
	cau_hosted *hosted = cau_call_session(call);
	if (!hosted)
		return;
	if (!cau_rpc_params(call->message, &params, &error)) {
		bool anybodys = params.has_number && asker->role == CAU_ROLE_ADMIN;
		uint64_t number = params.has_number ? (uint64_t)params.number : 0;
		result.count = cau_hosted_cancel(hosted, anybodys ? 0 : asker->client, number);
		if (number && !result.count)
			cau_fail(&error, CAU_NOT_FOUND, "params.number",
			         "this client has no waiting command with this number");
	}
	if (error.status)
		cau_call_fail(call, &error, 0);
	else
		cau_call_result(call, &result);
	cau_hosted_release(hosted);
}

void cau_call_session_timeline(cau_call *call)
{
	cau_wire_session_timeline params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_TIMELINE, &params);
	if (order) {
		order->as.timeline.from_tick = (uint64_t)params.from_tick;
		order->as.timeline.count = params.has_count ? (int32_t)params.count : TIMELINE_COUNT;
	}
	submit(call, order);
}

void cau_call_session_export(cau_call *call)
{
	cau_wire_session_export params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_EXPORT, &params);
	if (order)
		order->as.format = params.format;
	submit(call, order);
}

void cau_call_session_frame_at(cau_call *call)
{
	cau_wire_session_frame_at params = {0};
	cau_stream_def defaults = cau_default_stream_def();
	cau_order *order = cau_call_order_with(call, CAU_ORDER_FRAME_AT, &params);
	if (order) {
		order->as.frame_at.tick = (uint64_t)params.tick;
		order->as.frame_at.plain = params.has_plain && params.plain;
		order->as.frame_at.step_m = params.has_step_m ? params.step_m : defaults.step_m;
		order->as.frame_at.channels = params.has_channels ? params.channels : defaults.channels;
	}
	submit(call, order);
}

void cau_call_session_frame_cancel(cau_call *call)
{
	submit_plain(call, CAU_ORDER_FRAME_CANCEL);
}

void cau_call_session_log(cau_call *call)
{
	cau_wire_session_log params = {0};
	cau_order *order = cau_call_order_with(call, CAU_ORDER_LOG, &params);
	if (order) {
		order->as.log.from_tick = (uint64_t)params.from_tick;
		order->as.log.to_tick = params.has_to_tick ? (uint64_t)params.to_tick : UINT64_MAX;
	}
	submit(call, order);
}

// ---- store.backup, a method for administrators
void cau_call_store_backup(cau_call *call)
{
	cau_error error = {0};
	cau_wire_store_backup params = {0};
	cau_reply reply = cau_call_reply(call);
	// the store contains all sessions, so the token must be for all
	if (*call->peer->bounds.sessions) {
		cau_call_may_use(call, "");
		return;
	}
	if (cau_rpc_params(call->message, &params, &error) ||
	    cau_backups_make(&call->peer->service->backups, params.has_name ? params.name : "", &reply,
	                     &error))
		cau_call_fail(call, &error, 0);
}
