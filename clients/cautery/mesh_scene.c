// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/mesh_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cautery/defaults.h"

static const double tool_height_m = 0.03;

static void name_after_file(const char *file, char name[CAU_NAME_BYTES])
{
	const char *slash = strrchr(file, '/');
	size_t used = 0;
	for (const char *at = slash ? slash + 1 : file; *at && *at != '.' && used < CAU_NAME_BYTES - 1;
	     at++) {
		char c = *at >= 'A' && *at <= 'Z' ? (char)(*at - 'A' + 'a') : *at;
		bool letter = c >= 'a' && c <= 'z', digit = c >= '0' && c <= '9';
		if (letter || (digit && used))
			name[used++] = c;
		else if (used && name[used - 1] != '-')
			name[used++] = '-';
	}
	while (used && name[used - 1] == '-')
		used--;
	name[used] = 0;
	if (!used)
		memcpy(name, "mesh", sizeof "mesh");
}

cau_status cli_mesh_scene_begin(cau_scene_def *scene, const char *file, double unit_m, bool fat,
                                cau_error *error)
{
	cau_default_scene_def(scene);
	scene->parting = CAU_PARTING_ELEMENTS; // whoever made the mesh did not make it for its edges
	name_after_file(file, scene->name);
	cau_mesh_def *mesh = &scene->meshes[scene->mesh_count++];
	cau_default_mesh_def(mesh);
	snprintf(mesh->name, sizeof mesh->name, "mesh");
	mesh->source = CAU_MESH_FILE;
	mesh->unit_m = unit_m;
	if (strlen(file) >= sizeof mesh->file)
		return cau_fail(error, CAU_LIMIT, NULL, "a file name of more than %zu bytes",
		                sizeof mesh->file - 1);
	snprintf(mesh->file, sizeof mesh->file, "%s", file);
	cau_layer_def *layer = &scene->layers[scene->layer_count++];
	cau_default_layer_def(layer, fat ? CAU_LAYER_FAT : CAU_LAYER_FASCIA);
	snprintf(layer->name, sizeof layer->name, "%s", fat ? "fat" : "fascia");
	snprintf(layer->mesh, sizeof layer->mesh, "mesh");
	if (fat) {
		cau_layer_def *membrane = &scene->layers[scene->layer_count++];
		cau_default_layer_def(membrane, CAU_LAYER_MEMBRANE);
		snprintf(membrane->name, sizeof membrane->name, "membrane");
		snprintf(membrane->of, sizeof membrane->of, "fat");
	}
	return CAU_OK;
}

void cli_mesh_scene_measure(const cau_client_stream *stream, double least_m[3], double most_m[3])
{
	for (int a = 0; a < 3; a++) {
		least_m[a] = INFINITY;
		most_m[a] = -INFINITY;
	}
	for (int32_t i = 0; stream->has_topology && i < stream->def.vertex_count; i++)
		for (int a = 0; a < 3; a++) {
			double x = stream->def.origin_m[a] +
			           stream->def.step_m * stream->topology.rest[3 * (size_t)i + (size_t)a];
			least_m[a] = fmin(least_m[a], x);
			most_m[a] = fmax(most_m[a], x);
		}
}

void cli_mesh_scene_end(cau_scene_def *scene, const double least_m[3], const double most_m[3])
{
	bool sheet = scene->layers[0].kind == CAU_LAYER_FASCIA;
	cau_selection *pin = &scene->pins[scene->pin_count++];
	cau_default_selection(pin, sheet ? CAU_SELECT_RIM : CAU_SELECT_BOX);
	snprintf(pin->layer, sizeof pin->layer, "%s", sheet ? "fascia" : "");
	double margin_m = 1e-3;
	for (int a = 0; a < 3 && !sheet; a++) {
		pin->least_m[a] = least_m[a] - margin_m;
		pin->most_m[a] = most_m[a] + margin_m;
	}
	if (!sheet)
		pin->most_m[2] = least_m[2] + 0.1 * (most_m[2] - least_m[2]);
	cau_tool_def *tool = &scene->tools[scene->tool_count++];
	cau_default_tool_def(tool, CAU_TOOL_SPHERE);
	strcpy(tool->name, "ball");
	for (int a = 0; a < 2; a++)
		tool->pose.position_m[a] = 0.5 * (least_m[a] + most_m[a]);
	tool->pose.position_m[2] = most_m[2] + tool_height_m;
}
