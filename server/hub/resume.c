// SPDX-License-Identifier: GPL-3.0-or-later
// Starts the sessions of the store and the demo when the daemon starts.
#include <stdlib.h>
#include <string.h>

#include "cautery/scene_json.h"
#include "hub/internal.h"

typedef struct ids {
	char (*id)[CAU_STORE_ID_BYTES];
	int32_t count, capacity;
} ids;

static cau_status take_id(void *user, const cau_store_session *session)
{
	ids *list = user;
	if (list->count == list->capacity) {
		int32_t capacity = list->capacity ? 2 * list->capacity : 32;
		void *grown = realloc(list->id, (size_t)capacity * sizeof *list->id);
		if (!grown)
			return CAU_NO_MEMORY;
		list->id = grown;
		list->capacity = capacity;
	}
	snprintf(list->id[list->count++], CAU_STORE_ID_BYTES, "%s", session->id);
	return CAU_OK;
}

static cau_status take_meshes(cau_creation *creation, const cau_store_bytes *mesh, cau_error *error)
{
	if (mesh->bytes) {
		creation->meshes = malloc(mesh->bytes);
		if (!creation->meshes)
			return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the meshes");
		memcpy(creation->meshes, mesh->data, mesh->bytes);
		creation->mesh_bytes = mesh->bytes;
	}
	return cau_meshes_unpack(creation->scene, creation->meshes, creation->mesh_bytes, error);
}

static cau_status take_session(void *user, const cau_store_session *row)
{
	cau_creation *creation = user;
	cau_error error = {0};
	cau_status status = cau_scene_from_json(row->id, row->definition.data, row->definition.bytes,
	                                        creation->scene, &error);
	if (!status)
		status = take_meshes(creation, &row->mesh, &error);
	creation->paused = strcmp(row->state, "paused") == 0;
	creation->origin = (cau_hosted_origin){.kind = CAU_ORIGIN_STORE, .branch = row->branch};
	if (status)
		cau_log(CAU_LOG_ERROR, row->id, "definition_refused", "path=%s reason=\"%s\"", error.path,
		        error.reason);
	return status;
}

cau_status cau_hub_read_session(cau_hub *hub, const char *id, cau_creation **read, cau_error *error)
{
	cau_creation *creation = calloc(1, sizeof *creation);
	if (creation)
		creation->scene = calloc(1, sizeof *creation->scene);
	cau_status status =
		creation && creation->scene
			? cau_store_read_session(hub->def.store, id, take_session, creation, error)
			: cau_fail(error, CAU_NO_MEMORY, "", "no memory for a session");
	if (status) {
		if (creation)
			cau_creation_free(creation);
		return status;
	}
	snprintf(creation->scene->directory, sizeof creation->scene->directory, "%.255s",
	         hub->def.config->scenes);
	*read = creation;
	return CAU_OK;
}

cau_status cau_hub_resume_one(cau_hub *hub, const char *id, const cau_reply *reply,
                              cau_error *error)
{
	cau_creation *creation = NULL;
	cau_status status = cau_hub_read_session(hub, id, &creation, error);
	if (status)
		return status;
	creation->reply = *reply;
	status = cau_clerk_make(hub, creation, id, error);
	cau_creation_free(creation);
	return status;
}

// Resumes one session. A session that fails to start is reported and stays in the store. A session
// that is still arriving from another daemon is in doubt, and waits.
static bool resume_one(cau_hub *hub, const char *id)
{
	cau_error error = {0};
	if (cau_hub_arrives(hub, id))
		return false;
	cau_status status = cau_hub_resume_one(hub, id, &(cau_reply){0}, &error);
	if (status)
		cau_hosted_tell_not_resumed(id, status, &error);
	return !status;
}

static void note_scene(void *user, cau_hosted *hosted)
{
	cau_wire_session_summary summary;
	const char **wanted = user;
	cau_hosted_summary(hosted, &summary);
	if (*wanted && strcmp(summary.scene, *wanted) == 0)
		*wanted = NULL;
}

static cau_status make_demo(cau_hub *hub, cau_error *error)
{
	const char *missing = hub->def.config->demo;
	cau_hub_each(hub, note_scene, &missing);
	if (!missing)
		return CAU_OK;
	cau_creation *creation = calloc(1, sizeof *creation);
	if (creation)
		creation->scene = malloc(sizeof *creation->scene);
	if (!creation || !creation->scene) {
		free(creation);
		return cau_fail(error, CAU_NO_MEMORY, "demo", "no memory");
	}
	if (!cau_scenes_copy(hub->def.scenes, missing, creation->scene)) {
		cau_creation_free(creation);
		return cau_fail(error, CAU_NOT_FOUND, "demo", "there is no scene `%.60s`", missing);
	}
	snprintf(creation->name, sizeof creation->name, "%s", creation->scene->name);
	cau_hub_submit_creation(hub, creation);
	hub->last_resumed++; // the demo gets the next number, because no client is connected yet
	return CAU_OK;
}

typedef struct counting {
	uint32_t last_resumed;
	int32_t count;
} counting;

static void count_resuming(void *user, cau_hosted *hosted)
{
	counting *c = user;
	c->count += cau_hosted_number(hosted) <= c->last_resumed && cau_hosted_starting(hosted);
}

int32_t cau_hub_resuming(cau_hub *hub)
{
	counting c = {.last_resumed = hub->last_resumed};
	cau_hub_each(hub, count_resuming, &c);
	return c.count;
}

cau_status cau_hub_resume(cau_hub *hub, int32_t *resumed, cau_error *error)
{
	ids list = {0};
	*resumed = 0;
	cau_status status = cau_store_read_sessions(hub->def.store, take_id, &list, error);
	for (int32_t i = 0; !status && i < list.count; i++)
		*resumed += resume_one(hub, list.id[i]);
	hub->last_resumed = hub->last_session;
	free(list.id);
	if (!status && *hub->def.config->demo)
		status = make_demo(hub, error);
	return status;
}
