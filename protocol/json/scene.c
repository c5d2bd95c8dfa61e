// SPDX-License-Identifier: Apache-2.0
// Reads and writes scenes.
#include "cautery/scene_json.h"

#include <string.h>

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "json/document.h"

// ---- reading
// Reads the kind, the first field of a record. Defaults and members depend on it.
static bool read_kind(cau_reader *reader, const cJSON *object, const cau_record *record, void *base)
{
	CAU_ASSERT(record->field_count > 0 && record->kinds, "%s has no kinds", record->title);
	if (cau_read_object(reader, object))
		cau_read_field(reader, object, &record->fields[0], base);
	return reader->status == CAU_OK;
}

static void read_mesh(cau_reader *reader, const cJSON *object, void *element)
{
	cau_mesh_def *mesh = element;
	cau_default_mesh_def(mesh);
	if (!read_kind(reader, object, &cau_mesh_record, mesh))
		return;
	cau_part part = {&cau_mesh_record, mesh, mesh->source};
	cau_read_parts(reader, object, &part, 1, NULL, 0);
}

// Reads the differences of one region from the layer's own material.
static void read_region(cau_reader *reader, const cJSON *object, cau_layer_def *layer,
                        int32_t index)
{
	CAU_ASSERT(index > 0 && index < CAU_MAX_MATERIALS, "region %d", index);
	cau_part parts[CAU_MAX_PARTS];
	layer->sheet[index] = layer->sheet[0];
	layer->fat[index] = layer->fat[0];
	int count =
		cau_material_parts(layer->kind, &layer->sheet[index], &layer->fat[index], NULL, parts);
	int32_t *region =
		layer->kind == CAU_LAYER_FAT ? &layer->fat[index].region : &layer->sheet[index].region;
	parts[count++] = (cau_part){&cau_region_record, region, 0};
	if (cau_read_object(reader, object))
		cau_read_parts(reader, object, parts, count, NULL, 0);
}

static void read_regions(cau_reader *reader, const cJSON *array, cau_layer_def *layer)
{
	size_t mark = cau_reader_enter(reader, "regions", 0);
	if (cau_read_array(reader, array, 0, CAU_MAX_MATERIALS - 1))
		for (const cJSON *region = array->child; region; region = region->next) {
			size_t inner = cau_reader_enter(reader, NULL, layer->material_count - 1);
			read_region(reader, region, layer, layer->material_count++);
			cau_reader_leave(reader, inner);
		}
	cau_reader_leave(reader, mark);
}

static void read_layer(cau_reader *reader, const cJSON *object, void *element)
{
	cau_layer_def *layer = element;
	static const char *const others[] = {"regions"};
	cau_part parts[CAU_MAX_PARTS];
	if (!read_kind(reader, object, &cau_layer_record, layer))
		return;
	cau_default_layer_def(layer, layer->kind);
	int count = cau_material_parts(layer->kind, layer->sheet, layer->fat, &layer->link, parts);
	parts[count++] = (cau_part){&cau_layer_record, layer, layer->kind};
	bool regions = layer->kind != CAU_LAYER_LINKS;
	cau_read_parts(reader, object, parts, count, others, regions ? 1 : 0);
	const cJSON *array = cau_value_member(object, "regions");
	if (array && !reader->status)
		read_regions(reader, array, layer);
}

void cau_read_selection(cau_reader *reader, const cJSON *value, cau_selection *selection)
{
	cau_default_selection(selection, 0);
	if (!read_kind(reader, value, &cau_selection_record, selection))
		return;
	cau_part part = {&cau_selection_record, selection, selection->kind};
	cau_read_parts(reader, value, &part, 1, NULL, 0);
}

static void read_tool(cau_reader *reader, const cJSON *object, void *element)
{
	cau_tool_def *tool = element;
	cau_tool_choice choice;
	cau_default_tool_def(tool, 0);
	cau_part parts[] = {{&cau_instrument_record, &choice.names, 0},
	                    {&cau_tool_name_record, tool, 0},
	                    {&cau_tool_record, tool, 0},
	                    {&cau_pose_record, &tool->pose, 0}};
	if (!cau_read_object(reader, object))
		return;
	cau_begin_tool(reader, object, tool, &choice);
	cau_read_parts(reader, object, parts, 4, NULL, 0);
	cau_end_tool(reader, tool, &choice);
}

static void read_pull(cau_reader *reader, const cJSON *object, cau_pull_def *pull)
{
	static const char *const others[] = {"selection"};
	cau_part part = {&cau_pull_record, pull, 0};
	pull->present = 1;
	if (!cau_read_object(reader, object))
		return;
	cau_read_parts(reader, object, &part, 1, others, 1);
	size_t mark = cau_reader_enter(reader, "selection", 0);
	cau_read_selection(reader, cau_value_member(object, "selection"), &pull->selection);
	cau_reader_leave(reader, mark);
}

static void read_cut(cau_reader *reader, const cJSON *object, cau_cut_def *cut)
{
	cau_part part = {&cau_cut_record, cut, 0};
	cut->present = 1;
	if (cau_read_object(reader, object))
		cau_read_parts(reader, object, &part, 1, NULL, 0);
}

typedef void (*read_element)(cau_reader *reader, const cJSON *object, void *element);

static void read_list(cau_reader *reader, const cJSON *scene, const char *key, void *elements,
                      size_t element_bytes, int32_t most, int32_t *count, read_element read)
{
	const cJSON *array = cau_value_member(scene, key);
	if (!array || reader->status)
		return;
	size_t mark = cau_reader_enter(reader, key, 0);
	if (cau_read_array(reader, array, 0, most))
		for (const cJSON *object = array->child; object && !reader->status; object = object->next) {
			size_t inner = cau_reader_enter(reader, NULL, *count);
			CAU_ASSERT_INDEX(*count, most);
			read(reader, object, (char *)elements + (size_t)(*count)++ * element_bytes);
			cau_reader_leave(reader, inner);
		}
	cau_reader_leave(reader, mark);
}

static void read_vessel_point(cau_reader *reader, const cJSON *object, void *element)
{
	cau_part part = {&cau_vessel_point_record, element, 0};
	if (cau_read_object(reader, object))
		cau_read_parts(reader, object, &part, 1, NULL, 0);
}

static void read_vessel(cau_reader *reader, const cJSON *object, void *element)
{
	static const char *const others[] = {"points"};
	cau_vessel_def *vessel = element;
	cau_part part = {&cau_vessel_record, vessel, 0};
	cau_default_vessel_def(vessel);
	if (!cau_read_object(reader, object))
		return;
	cau_read_parts(reader, object, &part, 1, others, 1);
	read_list(reader, object, "points", vessel->points_m, sizeof *vessel->points_m,
	          CAU_MAX_VESSEL_POINTS, &vessel->point_count, read_vessel_point);
}

static void read_pin(cau_reader *reader, const cJSON *object, void *element)
{
	cau_read_selection(reader, object, element);
}

void cau_read_scene(cau_reader *reader, const cJSON *value, cau_scene_def *scene)
{
	static const char *const others[] = {"meshes",  "layers", "pins", "tools",
	                                     "vessels", "pull",   "cut"};
	cau_part part = {&cau_scene_record, scene, 0};
	cau_default_scene_def(scene);
	if (!cau_read_object(reader, value))
		return;
	cau_read_parts(reader, value, &part, 1, others, 7);
	read_list(reader, value, "meshes", scene->meshes, sizeof *scene->meshes, CAU_MAX_MESHES,
	          &scene->mesh_count, read_mesh);
	read_list(reader, value, "layers", scene->layers, sizeof *scene->layers, CAU_MAX_LAYERS,
	          &scene->layer_count, read_layer);
	read_list(reader, value, "pins", scene->pins, sizeof *scene->pins, CAU_MAX_PINS,
	          &scene->pin_count, read_pin);
	read_list(reader, value, "tools", scene->tools, sizeof *scene->tools, CAU_MAX_TOOLS,
	          &scene->tool_count, read_tool);
	read_list(reader, value, "vessels", scene->vessels, sizeof *scene->vessels, CAU_MAX_VESSELS,
	          &scene->vessel_count, read_vessel);
	const cJSON *pull = cau_value_member(value, "pull"), *cut = cau_value_member(value, "cut");
	if (pull) {
		size_t mark = cau_reader_enter(reader, "pull", 0);
		read_pull(reader, pull, &scene->pull);
		cau_reader_leave(reader, mark);
	}
	if (cut) {
		size_t mark = cau_reader_enter(reader, "cut", 0);
		read_cut(reader, cut, &scene->cut);
		cau_reader_leave(reader, mark);
	}
}

cau_status cau_scene_from_json(const char *name, const char *text, size_t bytes,
                               cau_scene_def *scene, cau_error *error)
{
	cau_reader reader;
	cJSON *value;
	if (error)
		snprintf(error->file, sizeof error->file, "%s", name ? name : "");
	cau_status status = cau_value_parse(text, bytes, CAU_SCENE_JSON_MAX_BYTES, &value, error);
	if (status)
		return status;
	cau_reader_begin(&reader, NULL, error);
	cau_read_scene(&reader, value, scene);
	cJSON_Delete(value);
	return reader.status;
}

// ---- writing
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

static void write_layer(cau_json_writer *writer, const cau_layer_def *layer, int32_t index)
{
	if (layer->material_count < 1 || layer->material_count > CAU_MAX_MATERIALS) {
		cau_json_fail(writer, CAU_BAD_VALUE, "layers[%d] has %d materials, not 1 to %d", index,
		              layer->material_count, CAU_MAX_MATERIALS);
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

static void write_vessel(cau_json_writer *writer, const cau_vessel_def *vessel, int32_t index)
{
	if (vessel->point_count < 0 || vessel->point_count > CAU_MAX_VESSEL_POINTS) {
		cau_json_fail(writer, CAU_BAD_VALUE, "vessels[%d] has %d points, more than %d", index,
		              vessel->point_count, CAU_MAX_VESSEL_POINTS);
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
		write_vessel(writer, &scene->vessels[i], i);
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
		cau_json_fail(
			writer, CAU_BAD_VALUE,
			"the scene has %d meshes, %d layers, %d pins, %d tools and %d vessels; the limits "
			"are %d, %d, %d, %d and %d",
			scene->mesh_count, scene->layer_count, scene->pin_count, scene->tool_count,
			scene->vessel_count, CAU_MAX_MESHES, CAU_MAX_LAYERS, CAU_MAX_PINS, CAU_MAX_TOOLS,
			CAU_MAX_VESSELS);
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
		write_layer(writer, &scene->layers[i], i);
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
