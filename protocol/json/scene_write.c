// SPDX-License-Identifier: Apache-2.0
#include "cautery/scene_json.h"

#include "cautery/assert.h"
#include "json/document.h"
#include "json/fields.h"

// Writes a part. Its base is not const, because reading uses the same type, but writing does not
// change it.
static void write_part(cau_json_writer *writer, const cau_record *record, const void *base,
                       int kind)
{
	cau_part part = {record, (void *)base, kind};
	cau_write_parts(writer, &part, 1);
}

static void write_material(cau_json_writer *writer, const cau_layer_def *layer, int32_t index)
{
	CAU_ASSERT_INDEX(index, layer->material_count);
	cau_part parts[CAU_MAX_PARTS];
	cau_layer_def *shared = (cau_layer_def *)layer;
	int count = cau_material_parts(layer->kind, &shared->sheet[index], &shared->fat[index],
	                               &shared->link, parts);
	cau_write_parts(writer, parts, count);
}

static void write_regions(cau_json_writer *writer, const cau_layer_def *layer)
{
	cau_json_open(writer, "regions", '[');
	for (int32_t i = 1; i < layer->material_count; i++) {
		const int32_t *region =
			layer->kind == CAU_LAYER_FAT ? &layer->fat[i].region : &layer->sheet[i].region;
		cau_json_open(writer, NULL, '{');
		write_part(writer, &cau_region_record, region, 0);
		write_material(writer, layer, i);
		cau_json_close(writer);
	}
	cau_json_close(writer);
}

static void write_layer(cau_json_writer *writer, const cau_layer_def *layer)
{
	if (layer->material_count < 1 || layer->material_count > CAU_MAX_MATERIALS) {
		cau_json_fail(writer, CAU_BAD_VALUE, "the layer has no materials, or too many");
		return;
	}
	cau_json_open(writer, NULL, '{');
	write_part(writer, &cau_layer_record, layer, layer->kind);
	write_material(writer, layer, 0);
	if (layer->kind != CAU_LAYER_LINKS && layer->material_count > 1)
		write_regions(writer, layer);
	cau_json_close(writer);
}

void cau_write_selection(cau_json_writer *writer, const char *key, const cau_selection *selection)
{
	cau_json_open(writer, key, '{');
	write_part(writer, &cau_selection_record, selection, selection->kind);
	cau_json_close(writer);
}

static void write_tool(cau_json_writer *writer, const cau_tool_def *tool)
{
	cau_json_open(writer, NULL, '{');
	write_part(writer, &cau_tool_name_record, tool, 0);
	write_part(writer, &cau_tool_record, tool, 0);
	write_part(writer, &cau_pose_record, &tool->pose, 0);
	cau_json_close(writer);
}

static void write_vessel(cau_json_writer *writer, const cau_vessel_def *vessel)
{
	if (vessel->point_count < 0 || vessel->point_count > CAU_MAX_VESSEL_POINTS) {
		cau_json_fail(writer, CAU_BAD_VALUE, "the vessel has too many points");
		return;
	}
	cau_json_open(writer, NULL, '{');
	write_part(writer, &cau_vessel_record, vessel, 0);
	cau_json_open(writer, "points", '[');
	for (int32_t i = 0; i < vessel->point_count; i++) {
		cau_json_open(writer, NULL, '{');
		write_part(writer, &cau_vessel_point_record, vessel->points_m[i], 0);
		cau_json_close(writer);
	}
	cau_json_close(writer);
	cau_json_close(writer);
}

static void write_vessels(cau_json_writer *writer, const cau_scene_def *scene)
{
	if (!scene->vessel_count)
		return;
	cau_json_open(writer, "vessels", '[');
	for (int32_t i = 0; i < scene->vessel_count; i++)
		write_vessel(writer, &scene->vessels[i]);
	cau_json_close(writer);
}

static void write_motions(cau_json_writer *writer, const cau_scene_def *scene)
{
	if (scene->pull.present) {
		cau_json_open(writer, "pull", '{');
		cau_write_selection(writer, "selection", &scene->pull.selection);
		write_part(writer, &cau_pull_record, &scene->pull, 0);
		cau_json_close(writer);
	}
	if (scene->cut.present) {
		cau_json_open(writer, "cut", '{');
		write_part(writer, &cau_cut_record, &scene->cut, 0);
		cau_json_close(writer);
	}
}

static bool counts_fit(const cau_scene_def *scene)
{
	return scene->mesh_count >= 0 && scene->mesh_count <= CAU_MAX_MESHES &&
	       scene->layer_count >= 0 && scene->layer_count <= CAU_MAX_LAYERS &&
	       scene->pin_count >= 0 && scene->pin_count <= CAU_MAX_PINS && scene->tool_count >= 0 &&
	       scene->tool_count <= CAU_MAX_TOOLS && scene->vessel_count >= 0 &&
	       scene->vessel_count <= CAU_MAX_VESSELS;
}

void cau_write_scene(cau_json_writer *writer, const char *key, const cau_scene_def *scene)
{
	if (!counts_fit(scene)) {
		cau_json_fail(writer, CAU_BAD_VALUE, "a count of the scene is out of range");
		return;
	}
	cau_json_open(writer, key, '{');
	write_part(writer, &cau_scene_record, scene, 0);
	cau_json_open(writer, "meshes", '[');
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		cau_json_open(writer, NULL, '{');
		write_part(writer, &cau_mesh_record, &scene->meshes[i], scene->meshes[i].source);
		cau_json_close(writer);
	}
	cau_json_close(writer);
	cau_json_open(writer, "layers", '[');
	for (int32_t i = 0; i < scene->layer_count; i++)
		write_layer(writer, &scene->layers[i]);
	cau_json_close(writer);
	cau_json_open(writer, "pins", '[');
	for (int32_t i = 0; i < scene->pin_count; i++)
		cau_write_selection(writer, NULL, &scene->pins[i]);
	cau_json_close(writer);
	cau_json_open(writer, "tools", '[');
	for (int32_t i = 0; i < scene->tool_count; i++)
		write_tool(writer, &scene->tools[i]);
	cau_json_close(writer);
	write_vessels(writer, scene);
	write_motions(writer, scene);
	cau_json_close(writer);
}

cau_status cau_scene_to_json(const cau_scene_def *scene, char *buffer, size_t capacity,
                             size_t *bytes, cau_error *error)
{
	cau_json_writer writer;
	cau_json_begin(&writer, buffer, capacity, 2);
	cau_write_scene(&writer, NULL, scene);
	return cau_json_end(&writer, bytes, error);
}
