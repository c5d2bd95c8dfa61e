// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

enum { MOST_SCENES = 256 };

void cau_call_scene_list(cau_call *call)
{
	static cau_wire_scene_summary list[MOST_SCENES]; // the network thread's alone
	const cau_scenes *scenes = cau_hub_scenes(call->peer->service->hub);
	cau_wire_scene_list result = {.scenes = {list, cau_scenes_count(scenes), MOST_SCENES}};
	for (int32_t i = 0; i < result.scenes.count; i++) {
		const cau_scene_def *scene = cau_scenes_at(scenes, i);
		memset(&list[i], 0, sizeof list[i]);
		snprintf(list[i].name, sizeof list[i].name, "%s", scene->name);
		snprintf(list[i].description, sizeof list[i].description, "%s", scene->description);
	}
	cau_call_result(call, &result);
}

bool cau_scene_answers_make(cau_service *service)
{
	const cau_rpc_id id = {.kind = CAU_RPC_ID_NUMBER};
	const cau_scenes *scenes = cau_hub_scenes(service->hub);
	int32_t count = cau_scenes_count(scenes);
	cau_error error = {0};
	service->scene_answers = calloc((size_t)count + 1, sizeof(cau_buffer *));
	for (int32_t i = 0; service->scene_answers && i < count; i++) {
		cau_wire_scene_result result = {.definition = (cau_scene_def *)cau_scenes_at(scenes, i)};
		service->scene_answers[i] = cau_result_text(&id, CAU_METHOD_SCENE_GET, &result, &error);
		if (!service->scene_answers[i])
			return false;
	}
	return service->scene_answers;
}

void cau_scene_answers_free(cau_service *service)
{
	for (cau_buffer **answer = service->scene_answers; answer && *answer; answer++)
		cau_buffer_release(*answer);
	free(service->scene_answers);
}

void cau_call_scene_get(cau_call *call)
{
	cau_error error = {0};
	cau_wire_scene_ref params = {0};
	if (cau_rpc_params(call->message, &params, &error)) {
		cau_call_fail(call, &error, 0);
		return;
	}
	const cau_service *service = call->peer->service;
	const cau_scenes *scenes = cau_hub_scenes(service->hub);
	int32_t scene = 0, count = cau_scenes_count(scenes);
	while (scene < count && strcmp(cau_scenes_at(scenes, scene)->name, params.scene) != 0)
		scene++;
	if (scene < count) {
		cau_buffer *answer = service->scene_answers[scene];
		if (call->message->kind == CAU_RPC_REQUEST)
			cau_call_answer(call, cau_answer_with_id((const char *)cau_buffer_bytes(answer),
			                                         answer->byte_count, &call->message->id));
		return;
	}
	cau_fail(&error, CAU_NOT_FOUND, "params.scene", "there is no scene `%.48s`", params.scene);
	cau_call_fail(call, &error, 0);
}
