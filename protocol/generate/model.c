// SPDX-License-Identifier: Apache-2.0
#include "generate/model.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/defaults.h"
#include "json/document.h"

// ---- building blocks ----------------------------------------------------------------------------

// Converts a name to PascalCase: session_summary to SessionSummary, tool.add to ToolAdd.
static void pascal(char *to, size_t bytes, const char *from)
{
	bool start = true;
	size_t used = 0;
	for (; *from && used + 1 < bytes; from++) {
		if (*from == '_' || *from == '.') {
			start = true;
			continue;
		}
		to[used++] = start ? (char)toupper((unsigned char)*from) : *from;
		start = false;
	}
	to[used] = 0;
}

static void copy_name(char to[NAME_BYTES], const char *from)
{
	size_t length = strlen(from);
	if (length >= NAME_BYTES)
		abort();
	memcpy(to, from, length + 1);
}

static type *add_type(model *to, const char *name, const char *meaning)
{
	if (to->type_count == TYPES_MAX)
		abort();
	type *added = &to->types[to->type_count++];
	copy_name(added->name, name);
	added->meaning = meaning;
	return added;
}

static property *add_property(type *to, const char *name, property_kind kind, const char *meaning)
{
	if (to->property_count == PROPERTIES_MAX)
		abort();
	property *added = &to->properties[to->property_count++];
	*added = (property){.name = name, .kind = kind, .meaning = meaning, .fixed = -1, .unit = ""};
	return added;
}

static void add_object(type *to, const char *name, const char *of, bool required,
                       const char *meaning)
{
	property *added = add_property(to, name, PROPERTY_OBJECT, meaning);
	added->type = of;
	added->required = required;
}

static void add_objects(type *to, const char *name, const char *of, int32_t most,
                        const char *meaning)
{
	property *added = add_property(to, name, PROPERTY_OBJECTS, meaning);
	added->type = of;
	added->count = most;
}

const type *model_find(const model *of, const char *name)
{
	for (int i = 0; i < of->type_count; i++)
		if (strcmp(of->types[i].name, name) == 0)
			return &of->types[i];
	return NULL;
}

// ---- records of scenes and commands

static property_kind kind_of_field(const cau_field *field)
{
	switch (field->type) {
	case CAU_FIELD_NUMBER:
		return field->count ? PROPERTY_NUMBERS : PROPERTY_NUMBER;
	case CAU_FIELD_INTEGER:
		return field->count ? PROPERTY_INTEGERS : PROPERTY_INTEGER;
	case CAU_FIELD_COUNT:
		return PROPERTY_INTEGER;
	case CAU_FIELD_CHOICE:
		return PROPERTY_CHOICE;
	case CAU_FIELD_FLAG:
		return PROPERTY_FLAG;
	case CAU_FIELD_NAME:
		return PROPERTY_NAME;
	case CAU_FIELD_TEXT:
		return PROPERTY_TEXT;
	case CAU_FIELD_ROTATION:
		return PROPERTY_ROTATION;
	}
	abort();
}

static void add_field(type *to, const cau_field *field, const void *defaults)
{
	property *added = add_property(to, field->name, kind_of_field(field), field->meaning);
	bool whole = field->type == CAU_FIELD_COUNT;
	added->required = field->required && !field->unless;
	added->unless = field->unless;
	added->least = whole ? 0.0 : field->least;
	added->most = whole ? 9007199254740991.0 : field->most;
	added->count = field->type == CAU_FIELD_TEXT ? CAU_TEXT_BYTES - 1 : field->count;
	added->least_count = field->least_count ? field->least_count : field->count;
	added->choices = field->choices;
	added->unit = field->unit;
	if (added->kind == PROPERTY_NUMBER && !field->required && defaults)
		added->default_value =
			(const double *)(const void *)((const char *)defaults + field->offset);
}

// Adds the fields of a kind. Kind -1 adds the fields of all kinds; then only fields that every kind
// has can be required.
static void add_record(type *to, const cau_record *record, const void *defaults, int kind)
{
	for (int i = 0; i < record->field_count; i++) {
		const cau_field *field = &record->fields[i];
		if (kind >= 0 && !cau_field_applies(field, kind))
			continue;
		add_field(to, field, defaults);
		if (kind < 0 && field->kinds)
			to->properties[to->property_count - 1].required = false;
	}
}

static void fix_choice(type *of, const char *name, int word)
{
	for (int i = 0; i < of->property_count; i++)
		if (strcmp(of->properties[i].name, name) == 0)
			of->properties[i].fixed = word;
}

static void drop_property(type *from, const char *name)
{
	for (int i = 0; i < from->property_count; i++) {
		if (strcmp(from->properties[i].name, name) != 0)
			continue;
		memmove(&from->properties[i], &from->properties[i + 1],
		        (size_t)(from->property_count - i - 1) * sizeof *from->properties);
		from->property_count--;
		return;
	}
}

// ---- scenes -------------------------------------------------------------------------------------

static cau_layer_def layer_defaults[CAU_LAYER_COUNT];
static cau_scene_def scene_defaults;
static cau_mesh_def mesh_defaults;
static cau_tool_def tool_defaults;
static cau_selection selection_defaults;
static cau_vessel_def vessel_defaults;

static const char *const layer_words[] = {
#define X(code, name) name,
	CAU_LAYER_TABLE(X)
#undef X
};

static void add_material(type *to, int kind)
{
	cau_part parts[2];
	cau_layer_def *defaults = &layer_defaults[kind];
	int count = cau_material_parts(kind, defaults->sheet, defaults->fat, &defaults->link, parts);
	for (int i = 0; i < count; i++)
		add_record(to, parts[i].record, parts[i].base, -1);
}

static void add_variant(type *to, const char *name)
{
	if (to->variant_count == VARIANTS_MAX)
		abort();
	copy_name(to->variants[to->variant_count++], name);
}

static void add_region(model *to, int kind, char name[NAME_BYTES])
{
	char word[24];
	pascal(word, sizeof word, layer_words[kind]);
	snprintf(name, NAME_BYTES, "%sRegion", word);
	type *region =
		add_type(to, name, "members of a region's material that differ from the layer's material");
	region->strict = true;
	add_record(region, &cau_region_record, NULL, -1);
	add_material(region, kind);
}

static void add_layer_types(model *to)
{
	static char region_names[CAU_LAYER_COUNT][NAME_BYTES];
	type *layer = add_type(to, "Layer", "a layer of tissue");
	for (int kind = 0; kind < CAU_LAYER_COUNT; kind++) {
		char name[NAME_BYTES], word[24];
		pascal(word, sizeof word, layer_words[kind]);
		snprintf(name, sizeof name, "%sLayer", word);
		add_variant(layer, name);
		if (kind != CAU_LAYER_LINKS)
			add_region(to, kind, region_names[kind]);
		type *variant = add_type(to, name, "a layer of this kind, with its material");
		variant->strict = true;
		add_record(variant, &cau_layer_record, NULL, kind);
		fix_choice(variant, "kind", kind);
		add_material(variant, kind);
		if (kind != CAU_LAYER_LINKS)
			add_objects(variant, "regions", region_names[kind], CAU_MAX_MATERIALS - 1,
			            "regions of the mesh file, with the members that differ");
	}
}

static void add_scene_parts(model *to)
{
	type *mesh = add_type(to, "Mesh", "a mesh of a scene");
	mesh->strict = true;
	add_record(mesh, &cau_mesh_record, &mesh_defaults, -1);
	type *selection = add_type(to, "Selection", "a selection of vertices by their rest positions");
	selection->strict = true;
	add_record(selection, &cau_selection_record, NULL, -1);
	type *tool = add_type(to, "Tool", "a tool of a scene");
	tool->strict = true;
	add_record(tool, &cau_tool_name_record, NULL, -1);
	add_record(tool, &cau_instrument_record, NULL, -1);
	add_record(tool, &cau_tool_record, &tool_defaults, -1);
	add_record(tool, &cau_pose_record, NULL, -1);
	type *point = add_type(to, "VesselPoint", "a point of the middle line of a vessel");
	point->strict = true;
	add_record(point, &cau_vessel_point_record, NULL, -1);
	type *vessel = add_type(to, "Vessel", "a blood vessel in a layer of fat");
	vessel->strict = true;
	add_record(vessel, &cau_vessel_record, &vessel_defaults, -1);
	add_objects(vessel, "points", "VesselPoint", CAU_MAX_VESSEL_POINTS,
	            "points of the middle line of the vessel");
	type *pull = add_type(to, "Pull", "a scripted pull, for measurements");
	pull->strict = true;
	add_record(pull, &cau_pull_record, &scene_defaults.pull, -1);
	add_object(pull, "selection", "Selection", true, "vertices that are pulled");
	type *cut = add_type(to, "Cut", "a scripted cut, for measurements");
	cut->strict = true;
	add_record(cut, &cau_cut_record, &scene_defaults.cut, -1);
}

static void add_scene_types(model *to)
{
	cau_default_scene_def(&scene_defaults);
	cau_default_mesh_def(&mesh_defaults);
	cau_default_tool_def(&tool_defaults, CAU_TOOL_HOOK);
	cau_default_vessel_def(&vessel_defaults);
	cau_default_selection(&selection_defaults, CAU_SELECT_RIM);
	for (int kind = 0; kind < CAU_LAYER_COUNT; kind++)
		cau_default_layer_def(&layer_defaults[kind], kind);
	add_scene_parts(to);
	add_layer_types(to);
	type *scene = add_type(to, "Scene", "the data from which a session is created");
	scene->strict = true;
	add_record(scene, &cau_scene_record, &scene_defaults, -1);
	add_objects(scene, "meshes", "Mesh", CAU_MAX_MESHES, "meshes of the layers");
	add_objects(scene, "layers", "Layer", CAU_MAX_LAYERS, "layers of tissue");
	add_objects(scene, "pins", "Selection", CAU_MAX_PINS, "pinned vertices");
	add_objects(scene, "tools", "Tool", CAU_MAX_TOOLS, "tools at the start");
	add_objects(scene, "vessels", "Vessel", CAU_MAX_VESSELS, "blood vessels");
	add_object(scene, "pull", "Pull", false, "a scripted pull");
	add_object(scene, "cut", "Cut", false, "a scripted cut");
}

// ---- commands -----------------------------------------------------------------------------------

static void add_envelope(type *to)
{
	property *session =
		add_property(to, "session", PROPERTY_NAME,
	                 "id of the session (default: the session in the connection's URL)");
	session->required = false;
	property *sequence =
		add_property(to, "client_sequence", PROPERTY_INTEGER, "see session_change");
	sequence->least = 1;
	sequence->most = 9007199254740991.0;
}

static void add_command_members(type *to, cau_command *command)
{
	cau_part parts[CAU_MAX_PARTS];
	int count = cau_command_parts(command, parts);
	add_envelope(to);
	for (int i = 0; i < count; i++) {
		bool head = parts[i].record == &cau_command_record;
		add_record(to, parts[i].record, head ? NULL : parts[i].base, head ? command->kind : -1);
	}
	if (command->kind == CAU_COMMAND_TOOL_ADD || command->kind == CAU_COMMAND_TOOL_CONFIGURE)
		add_record(to, &cau_instrument_record, NULL, -1);
	drop_property(to, "command");
	if (cau_command_selection(command))
		add_object(to, "selection", "Selection", true, "which vertices");
}

static void add_command(model *to, cau_method method, const char *name, cau_command *command)
{
	type *params = add_type(to, name, cau_method_describe(method)->meaning);
	params->strict = true;
	add_command_members(params, command);
}

static void add_material_command(model *to, cau_method method, const char *name)
{
	static cau_command commands[CAU_LAYER_COUNT];
	type *params = add_type(to, name, cau_method_describe(method)->meaning);
	for (int kind = 0; kind < CAU_LAYER_COUNT; kind++) {
		char variant[NAME_BYTES], word[24];
		cau_command *command = &commands[kind];
		cau_default_command(command, CAU_COMMAND_SET_MATERIAL);
		command->as.material.kind = kind;
		cau_default_heat_material(&command->as.material.sheet.heat, kind);
		pascal(word, sizeof word, layer_words[kind]);
		snprintf(variant, sizeof variant, "%.20s%.20s", name, word);
		add_variant(params, variant);
		add_command(to, method, variant, command);
		fix_choice(&to->types[to->type_count - 1], "kind", kind);
	}
}

static void add_commands(model *to)
{
	static cau_command commands[CAU_COMMAND_COUNT];
	for (int method = 0; method < CAU_METHOD_COUNT; method++) {
		const cau_method_info *info = cau_method_describe((cau_method)method);
		if (info->command < 0)
			continue;
		char *name = to->params[method];
		pascal(name, sizeof *to->params, info->name);
		cau_default_command(&commands[info->command], info->command);
		if (info->command == CAU_COMMAND_SET_MATERIAL)
			add_material_command(to, (cau_method)method, name);
		else
			add_command(to, (cau_method)method, name, &commands[info->command]);
	}
}

// ---- objects of messages.def

static const property_kind kinds[] = {
	[CAU_WIRE_TYPE_FLAG] = PROPERTY_FLAG,         [CAU_WIRE_TYPE_INTEGER] = PROPERTY_INTEGER,
	[CAU_WIRE_TYPE_NUMBER] = PROPERTY_NUMBER,     [CAU_WIRE_TYPE_VECTOR] = PROPERTY_NUMBERS,
	[CAU_WIRE_TYPE_TEXT] = PROPERTY_TEXT,         [CAU_WIRE_TYPE_NAME] = PROPERTY_NAME,
	[CAU_WIRE_TYPE_HEX64] = PROPERTY_HEX64,       [CAU_WIRE_TYPE_CHOICE] = PROPERTY_CHOICE,
	[CAU_WIRE_TYPE_CHOICES] = PROPERTY_CHOICES,   [CAU_WIRE_TYPE_PART] = PROPERTY_OBJECT,
	[CAU_WIRE_TYPE_LIST] = PROPERTY_OBJECTS,      [CAU_WIRE_TYPE_NUMBERS] = PROPERTY_NUMBERS,
	[CAU_WIRE_TYPE_INTEGERS] = PROPERTY_INTEGERS, [CAU_WIRE_TYPE_SCENE] = PROPERTY_OBJECT,
};

static char object_names[CAU_WIRE_OBJECT_COUNT][NAME_BYTES];

static void add_message(model *to, int object)
{
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	type *added = add_type(to, object_names[object], shape->meaning);
	for (int32_t i = 0; i < shape->field_count; i++) {
		const cau_wire_field *field = &shape->fields[i];
		bool refers = field->type == CAU_WIRE_TYPE_PART || field->type == CAU_WIRE_TYPE_LIST;
		property *made = add_property(added, field->name, kinds[field->type], field->meaning);
		made->required = field->required;
		made->least = field->least;
		made->most = field->most;
		made->count = made->least_count = field->count;
		if (field->type == CAU_WIRE_TYPE_NUMBERS || field->type == CAU_WIRE_TYPE_INTEGERS)
			made->least_count = 0;
		made->choices = field->choices;
		made->unit = field->unit ? field->unit : "";
		if (refers)
			made->type = object_names[field->object];
		if (field->type == CAU_WIRE_TYPE_SCENE)
			made->type = "Scene";
	}
}

static void add_messages(model *to)
{
	for (int object = 0; object < CAU_WIRE_OBJECT_COUNT; object++) {
		pascal(object_names[object], sizeof *object_names, cau_wire_shapes[object].name);
		add_message(to, object);
	}
}

static void name_methods(model *of)
{
	for (int method = 0; method < CAU_METHOD_COUNT; method++) {
		const cau_method_info *info = cau_method_describe((cau_method)method);
		bool answered = info->form == CAU_FORM_REQUEST || info->form == CAU_FORM_EITHER_WAY;
		if (answered)
			copy_name(of->results[method], object_names[info->result]);
		if (info->command >= 0)
			continue;
		copy_name(of->params[method], object_names[info->params]);
		if (info->form != CAU_FORM_PUSH)
			((type *)model_find(of, of->params[method]))->strict = true;
	}
}

void model_make(model *made)
{
	*made = (model){0};
	add_messages(made);
	add_scene_types(made);
	add_commands(made);
	name_methods(made);
}
