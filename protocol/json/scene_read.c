// SPDX-License-Identifier: Apache-2.0
#include "cautery/scene_json.h"

#include <string.h>

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "json/document.h"
#include "json/fields.h"
#include "json/instrument.h"

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
