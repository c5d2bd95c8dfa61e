// SPDX-License-Identifier: GPL-3.0-or-later
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

void cau_call_scene_get(cau_call *call)
{
	cau_error error = {0};
	cau_wire_scene_ref params = {0};
	if (cau_rpc_params(call->message, &params, &error)) {
		cau_call_fail(call, &error, 0);
		return;
	}
	const cau_scene_def *scene =
		cau_scenes_find(cau_hub_scenes(call->peer->service->hub), params.scene);
	if (!scene) {
		cau_fail(&error, CAU_NOT_FOUND, "params.scene", "there is no scene `%.48s`", params.scene);
		cau_call_fail(call, &error, 0);
		return;
	}
	cau_wire_scene_result result = {.definition = (cau_scene_def *)scene};
	cau_call_result(call, &result);
}
