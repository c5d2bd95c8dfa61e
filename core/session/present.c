// SPDX-License-Identifier: GPL-3.0-or-later
// Returns a session's definition in its present state. The definition includes all changes by
// commands, also by queued commands. So a client that has the answer to a command finds the
// command's effect here, even while the session is paused.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

static cau_layer_def *find_layer(cau_scene_def *scene, const char *name)
{
	for (int32_t i = 0; i < scene->layer_count; i++)
		if (strcmp(scene->layers[i].name, name) == 0)
			return &scene->layers[i];
	return NULL;
}

static int32_t find_tool(const cau_scene_def *scene, const char *name)
{
	for (int32_t i = 0; i < scene->tool_count; i++)
		if (strcmp(scene->tools[i].name, name) == 0)
			return i;
	return -1;
}

static void present_layers(const cau_session *session, cau_scene_def *scene)
{
	const cau_tissue *tissue = &session->tissue;
	for (int32_t i = 0; i < tissue->layer_count; i++) {
		const cau_layer_def *now = &tissue->layer[i].def;
		cau_layer_def *layer = find_layer(scene, now->name);
		if (!layer)
			continue;
		memcpy(layer->sheet, now->sheet, sizeof layer->sheet);
		memcpy(layer->fat, now->fat, sizeof layer->fat);
		layer->link = now->link;
	}
}

static void present_tools(const cau_session *session, cau_scene_def *scene)
{
	CAU_ASSERT(session->tool_count <= CAU_MAX_TOOLS, "%d tools", session->tool_count);
	scene->tool_count = session->tool_count;
	for (int32_t i = 0; i < session->tool_count; i++) {
		const cau_tool_state *now = &session->tool[i].state;
		scene->tools[i] = now->definition;
		memcpy(scene->tools[i].name, now->name, sizeof now->name);
		scene->tools[i].pose = now->pose;
	}
}

static void add_tool(cau_scene_def *scene, const cau_tool_def *tool)
{
	if (scene->tool_count < CAU_MAX_TOOLS && find_tool(scene, tool->name) < 0)
		scene->tools[scene->tool_count++] = *tool;
}

static void remove_tool(cau_scene_def *scene, int32_t index)
{
	if (index < 0)
		return;
	scene->tool_count--;
	CAU_ASSERT(index <= scene->tool_count && scene->tool_count >= 0, "tool %d of %d", index,
	           scene->tool_count);
	memmove(&scene->tools[index], &scene->tools[index + 1],
	        (size_t)(scene->tool_count - index) * sizeof *scene->tools);
}

static void configure_tool(cau_scene_def *scene, int32_t index, const cau_tool_def *to)
{
	if (index < 0)
		return;
	cau_tool_def before = scene->tools[index];
	CAU_ASSERT_INDEX(index, scene->tool_count);
	scene->tools[index] = *to;
	scene->tools[index].pose = before.pose;
	memcpy(scene->tools[index].name, before.name, sizeof before.name);
}

static void take_command(cau_scene_def *scene, const cau_command *command)
{
	cau_layer_def *layer;
	switch (command->kind) {
	case CAU_COMMAND_SET_GRAVITY:
		memcpy(scene->gravity_m_s2, command->as.gravity_m_s2, sizeof scene->gravity_m_s2);
		break;
	case CAU_COMMAND_SET_MATERIAL:
		layer = find_layer(scene, command->as.material.layer);
		if (layer)
			cau_layer_take_material(layer, command);
		break;
	case CAU_COMMAND_TOOL_ADD:
		add_tool(scene, &command->as.definition);
		break;
	case CAU_COMMAND_TOOL_REMOVE:
		remove_tool(scene, find_tool(scene, command->tool));
		break;
	case CAU_COMMAND_TOOL_CONFIGURE:
		configure_tool(scene, find_tool(scene, command->tool), &command->as.definition);
		break;
	default:
		break;
	}
}

void cau_session_present(const cau_session *session, cau_scene_def *scene)
{
	memcpy(scene->gravity_m_s2, session->scene->gravity_m_s2, sizeof scene->gravity_m_s2);
	present_layers(session, scene);
	present_tools(session, scene);
	for (int32_t k = 0; k < session->queue.count; k++)
		take_command(scene, &session->queue.command[k]);
}
