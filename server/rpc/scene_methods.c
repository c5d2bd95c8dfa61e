// SPDX-License-Identifier: GPL-3.0-or-later
// The methods about scenes and about profiles of instruments.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/instrument.h"
#include "rpc/internal.h"

// ---- scenes
// The answers are made once for each edition, so that many requests cost the network thread little.

enum { MOST_SCENES = 256 };

typedef struct listing {
	cau_wire_scene_summary list[MOST_SCENES];
	int32_t count;
} listing;

static void add_summary(void *user, const cau_scene_def *scene)
{
	listing *into = user;
	if (into->count == MOST_SCENES)
		return;
	cau_wire_scene_summary *row = &into->list[into->count++];
	memset(row, 0, sizeof *row);
	snprintf(row->name, sizeof row->name, "%s", scene->name);
	snprintf(row->description, sizeof row->description, "%s", scene->description);
}

void cau_call_scene_list(cau_call *call)
{
	static listing all; // used by the network thread only
	all.count = 0;
	cau_scenes_each(cau_hub_scenes(call->peer->service->hub), add_summary, &all);
	cau_wire_scene_list result = {.scenes = {all.list, all.count, MOST_SCENES}};
	cau_call_result(call, &result);
}

struct cau_scene_answer {
	char name[CAU_NAME_BYTES];
	cau_buffer *text;
};

// Makes the answer of one scene. If memory runs out, the scene is missing from the answers.
static void add_answer(void *user, const cau_scene_def *scene)
{
	const cau_rpc_id id = {.kind = CAU_RPC_ID_NUMBER};
	cau_service *service = user;
	cau_error error = {0};
	cau_wire_scene_result result = {.definition = (cau_scene_def *)scene};
	cau_scene_answer *row = &service->scene_answers[service->scene_count];
	if (service->scene_count == MOST_SCENES)
		return;
	snprintf(row->name, sizeof row->name, "%s", scene->name);
	row->text = cau_result_text(&id, CAU_METHOD_SCENE_GET, &result, &error);
	service->scene_count += row->text != NULL;
}

bool cau_scene_answers_make(cau_service *service)
{
	cau_scenes *scenes = cau_hub_scenes(service->hub);
	cau_scene_answers_free(service);
	service->scene_answers = calloc(MOST_SCENES, sizeof *service->scene_answers);
	service->scene_edition = cau_scenes_edition(scenes);
	if (service->scene_answers)
		cau_scenes_each(scenes, add_answer, service);
	return service->scene_answers;
}

void cau_scene_answers_free(cau_service *service)
{
	for (int32_t i = 0; i < service->scene_count; i++)
		cau_buffer_release(service->scene_answers[i].text);
	free(service->scene_answers);
	service->scene_answers = NULL;
	service->scene_count = 0;
}

// Returns the answer of the scene with this name; NULL if there is none.
static cau_buffer *find_answer(cau_service *service, const char *name)
{
	bool old = service->scene_edition != cau_scenes_edition(cau_hub_scenes(service->hub));
	if (old && !cau_scene_answers_make(service))
		return NULL;
	for (int32_t i = 0; i < service->scene_count; i++)
		if (strcmp(service->scene_answers[i].name, name) == 0)
			return service->scene_answers[i].text;
	return NULL;
}

void cau_call_scene_get(cau_call *call)
{
	cau_error error = {0};
	cau_wire_scene_ref params = {0};
	if (cau_rpc_params(call->message, &params, &error)) {
		cau_call_fail(call, &error, 0);
		return;
	}
	cau_buffer *answer = find_answer(call->peer->service, params.scene);
	if (answer && call->message->kind == CAU_RPC_REQUEST)
		cau_call_answer(call, cau_answer_with_id((const char *)cau_buffer_bytes(answer),
		                                         answer->byte_count, &call->message->id));
	if (answer)
		return;
	cau_fail(&error, CAU_NOT_FOUND, "params.scene", "there is no scene `%.48s`", params.scene);
	cau_call_fail(call, &error, 0);
}

// ---- instruments
enum { MOST_INSTRUMENTS = 64 };

static const char *shape_word(int shape)
{
#define X(code, word, ...) #word,
	static const char *const words[] = {CAU_TOOL_SHAPE_TABLE(X)};
#undef X
	return words[shape];
}

static void describe_mode(const cau_instrument_mode *from, cau_wire_instrument_mode *to)
{
	*to = (cau_wire_instrument_mode){.power_w = from->tool.power_w,
	                                 .power_least_w = from->power_least_w,
	                                 .power_most_w = from->power_most_w,
	                                 .peak_v = from->tool.peak_v,
	                                 .crest_factor = from->tool.crest_factor,
	                                 .current_max_a = from->tool.current_max_a,
	                                 .load_rise_off = from->tool.load_rise_off};
	snprintf(to->mode, sizeof to->mode, "%s", from->name);
	snprintf(to->description, sizeof to->description, "%s", from->description);
}

static void describe_instrument(const cau_instrument *from, cau_wire_instrument *to,
                                cau_wire_instrument_mode *modes)
{
	memset(to, 0, sizeof *to);
	snprintf(to->name, sizeof to->name, "%s", from->name);
	snprintf(to->description, sizeof to->description, "%s", from->description);
	snprintf(to->shape, sizeof to->shape, "%s", shape_word(from->modes[0].tool.shape));
	for (int32_t m = 0; m < from->mode_count; m++)
		describe_mode(&from->modes[m], &modes[m]);
	to->modes = (cau_wire_list){modes, from->mode_count, CAU_MAX_MODES};
}

void cau_call_instrument_list(cau_call *call)
{
	static cau_wire_instrument list[MOST_INSTRUMENTS]; // used by the network thread only
	static cau_wire_instrument_mode modes[MOST_INSTRUMENTS][CAU_MAX_MODES];
	cau_error error = {0};
	cau_wire_instrument_list result = {.instruments = {list, 0, MOST_INSTRUMENTS}};
	for (int32_t i = 0; i < cau_instrument_count(); i++) {
		cau_instrument read;
		if (cau_instrument_read(i, &read, &error)) {
			cau_call_fail(call, &error, 0);
			return;
		}
		describe_instrument(&read, &list[i], modes[i]);
		result.instruments.count++;
	}
	cau_call_result(call, &result);
}
