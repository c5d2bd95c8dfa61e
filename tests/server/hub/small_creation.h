// SPDX-License-Identifier: GPL-3.0-or-later
// Returns a request to a hub: a paused session with one sheet and a hook.
#pragma once

#include <stdio.h>
#include <stdlib.h>

#include "cautery/defaults.h"
#include "hub/hub.h"

static inline cau_creation *small_creation(const char *name, cau_reply reply)
{
	cau_creation *creation = calloc(1, sizeof *creation);
	cau_scene_def *scene = creation->scene = calloc(1, sizeof *scene);
	cau_default_scene_def(scene);
	snprintf(scene->name, sizeof scene->name, "sheet");
	scene->layer_count = scene->tool_count = 1;
	cau_default_layer_def(&scene->layers[0], CAU_LAYER_FASCIA);
	snprintf(scene->layers[0].name, sizeof scene->layers[0].name, "sheet");
	cau_default_tool_def(&scene->tools[0], CAU_TOOL_HOOK);
	snprintf(scene->tools[0].name, sizeof scene->tools[0].name, "hook");
	snprintf(creation->name, sizeof creation->name, "%s", name);
	creation->paused = true;
	creation->reply = reply;
	return creation;
}
