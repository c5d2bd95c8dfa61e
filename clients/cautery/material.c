// SPDX-License-Identifier: GPL-3.0-or-later
// The command `material`: shows or changes the material of a layer.
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "cautery/cli.h"
#include "cautery/command_json.h"
#include "cautery/defaults.h"

// members of a material command that do not describe the material
static const char *const around[] = {"command", "tick", "sequence", "layer", "kind"};

// ---- the present material -----------------------------------------------------------------------
static cli_exit describe(cli *c, cau_scene_def *scene)
{
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_ref params = {0};
	cau_wire_session_description d = {.definition = scene,
	                                  .layers = {layers, 0, CAU_MAX_LAYERS},
	                                  .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	CLI_SESSION_PARAMS(c, &params);
	return cau_client_call(c->client, CAU_METHOD_SESSION_DESCRIBE, &params, &d, &c->error)
	           ? cli_fail(c)
	           : CLI_DONE;
}

static const cau_layer_def *find_layer(const cli *c, const cau_scene_def *scene, const char *name)
{
	const char *names[CAU_MAX_LAYERS];
	for (int32_t i = 0; i < scene->layer_count; i++) {
		names[i] = scene->layers[i].name;
		if (strcmp(names[i], name) == 0)
			return &scene->layers[i];
	}
	cli_complain_unknown(c, "layer", name, names, (size_t)scene->layer_count);
	return NULL;
}

// Returns the index of the region's own material. Returns 0, the layer's default, if the region has
// none.
static int32_t find_region(const cau_layer_def *layer, int32_t region)
{
	for (int32_t i = 1; i < layer->material_count; i++)
		if ((layer->kind == CAU_LAYER_FAT ? layer->fat[i].region : layer->sheet[i].region) ==
		    region)
			return i;
	return 0;
}

static void take_material(const cau_layer_def *layer, int32_t region, cau_command *command)
{
	int32_t i = find_region(layer, region);
	cau_default_command(command, CAU_COMMAND_SET_MATERIAL);
	memcpy(command->as.material.layer, layer->name, sizeof layer->name);
	command->as.material.kind = layer->kind;
	command->as.material.sheet = layer->sheet[i];
	command->as.material.fat = layer->fat[i];
	command->as.material.link = layer->link;
	command->as.material.sheet.region = command->as.material.fat.region = region;
}

// Returns the material as JSON, which the caller deletes. Returns NULL if it fails; then c->error
// has the reason.
static cJSON *tell_material(cli *c, const cau_command *command)
{
	char text[CAU_COMMAND_JSON_MAX_BYTES];
	if (cau_command_to_json(command, text, sizeof text, NULL, &c->error))
		return NULL;
	cJSON *json = cJSON_Parse(text);
	if (!json)
		cau_fail(&c->error, CAU_NO_MEMORY, NULL, "no memory for a material");
	return json;
}

// ---- changes ------------------------------------------------------------------------------------
static void complain_of_member(const cli *c, const cJSON *json, const char *name)
{
	enum { MOST = 256 };
	const char *names[MOST];
	size_t count = 0;
	for (const cJSON *m = json->child; m && count < MOST; m = m->next)
		names[count++] = m->string;
	cli_complain_unknown(c, "member", name, names, count);
}

// Applies NAME=VALUE. The value is JSON or a plain word.
static cli_exit change(cli *c, cJSON *json, const char *assignment)
{
	char name[64] = "";
	size_t length = strcspn(assignment, "=");
	if (!assignment[length] || length >= sizeof name) {
		cli_complain(c, "\"%s\" is not of the form NAME=VALUE", assignment);
		return CLI_USAGE;
	}
	memcpy(name, assignment, length);
	if (!cJSON_GetObjectItemCaseSensitive(json, name)) {
		complain_of_member(c, json, name);
		return CLI_USAGE;
	}
	const char *text = assignment + length + 1;
	cJSON *value = cJSON_ParseWithOpts(text, NULL, true);
	if (!value)
		value = cJSON_CreateString(text);
	if (!value || !cJSON_ReplaceItemInObjectCaseSensitive(json, name, value)) {
		cJSON_Delete(value);
		cau_fail(&c->error, CAU_NO_MEMORY, NULL, "no memory for a material");
		return cli_fail(c);
	}
	return CLI_DONE;
}

static cli_exit send(cli *c, const cJSON *json)
{
	cau_command command;
	char *text = cJSON_PrintUnformatted(json);
	if (!text)
		return cli_fail_memory(c);
	cau_status status = cau_command_from_json(text, strlen(text), &command, &c->error);
	free(text);
	if (status) {
		cli_fail(c);
		return CLI_USAGE;
	}
	return cli_command_session(c, &command, "another material");
}

static cli_exit print(const cli *c, cJSON *json)
{
	for (size_t i = 0; i < sizeof around / sizeof around[0]; i++)
		cJSON_DeleteItemFromObjectCaseSensitive(json, around[i]);
	char *text = c->json ? cJSON_PrintUnformatted(json) : NULL;
	if (text)
		fprintf(c->out, "%s\n", text);
	free(text);
	for (const cJSON *m = json->child; m && !c->json; m = m->next) {
		text = cJSON_PrintUnformatted(m);
		fprintf(c->out, "%s=%s\n", m->string, text ? text : "?");
		free(text);
	}
	return CLI_DONE;
}

static cli_exit show_or_change(cli *c, cau_scene_def *scene, int32_t region)
{
	cau_command command;
	cli_exit code = describe(c, scene);
	const cau_layer_def *layer = code ? NULL : find_layer(c, scene, c->arguments[1]);
	if (!layer)
		return code ? code : CLI_USAGE;
	take_material(layer, region, &command);
	cJSON *json = tell_material(c, &command);
	if (!json)
		return cli_fail(c);
	for (int i = 2; !code && i < c->argument_count; i++)
		code = change(c, json, c->arguments[i]);
	if (!code)
		code = c->argument_count > 2 ? send(c, json) : print(c, json);
	cJSON_Delete(json);
	return code;
}

static cli_exit run(cli *c)
{
	bool bad = false;
	int32_t region = (int32_t)cli_number(c, "region", 0, INT32_MAX, 0, &bad);
	snprintf(c->session, sizeof c->session, "%s", c->arguments[0]);
	cau_scene_def *scene = calloc(1, sizeof *scene);
	cli_exit code = CLI_USAGE;
	if (!bad)
		code = scene ? cli_connect(c) : cli_fail_memory(c);
	if (!code)
		code = show_or_change(c, scene, region);
	free(scene);
	return code;
}

const cli_command cli_material = {
	.name = "material",
	.arguments = "SESSION LAYER [NAME=VALUE...]",
	.summary = "shows a layer's material, or changes members of it",
	.help = "Without NAME=VALUE it lists the members; deploy/scenes/README.md explains them.\n",
	.least = 2,
	.most = CLI_ARGUMENTS_MAX,
	.options = {{"region", "R",
                 "number of a region in the mesh file (default: the layer's own material)"}},
	.run = run};
