// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/mesh_scene.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "mesh/mesh.h"

// Limits for guessing a unit. A unit is guessed only if no other unit makes an organ. An extent of
// up to 20 units is in centimetres, because millimetres would make at most 20 mm. A body beyond 20
// units is in millimetres, which scanners and segmentations write. A sheet of 20 to 80 units may be
// in centimetres too, so the user must give its unit.
static const double centimetres_most = 20;
static const double sheet_millimetres_least = 80;
static const double ball_radius_most_m = 0.03;
static const double tool_height_m = 0.03;

static double longest_of(const cau_mesh_report *report)
{
	double longest_m = 0;
	for (int c = 0; c < 3; c++)
		longest_m = fmax(longest_m, report->most_m[c] - report->least_m[c]);
	return longest_m;
}

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

static cau_status add_mesh(const cau_mesh_wish *wish, cau_scene_def *scene, cau_error *error)
{
	cau_mesh_def *mesh = &scene->meshes[scene->mesh_count++];
	cau_default_mesh_def(mesh);
	snprintf(mesh->name, sizeof mesh->name, "mesh");
	mesh->source = wish->bytes ? CAU_MESH_BYTES : CAU_MESH_FILE;
	mesh->bytes = wish->bytes;
	mesh->byte_count = wish->byte_count;
	mesh->unit_m = wish->unit_m > 0 ? wish->unit_m : 1;
	mesh->strict = wish->strict;
	if (strlen(wish->file) >= sizeof mesh->file)
		return cau_fail(error, CAU_LIMIT, "file", "a file name of more than %zu bytes",
		                sizeof mesh->file - 1);
	snprintf(mesh->file, sizeof mesh->file, "%s", wish->file);
	return CAU_OK;
}

static bool may_guess(const cau_mesh_report *report)
{
	bool body = report->tetrahedron_count > 0 || report->opening <= CAU_NEARLY_CLOSED;
	double longest = longest_of(report); // in units of the file, which were read as metres
	if (report->proposed_unit_m == 0.01)
		return longest <= centimetres_most;
	return report->proposed_unit_m == 0.001 &&
	       longest >= (body ? centimetres_most : sheet_millimetres_least);
}

// Reads the mesh for its report. Guesses the unit if none was given and the mesh in metres is too
// large or too small for tissue.
static cau_status read_report(const cau_mesh_wish *wish, cau_mesh_def *def, cau_mesh_report *report,
                              cau_error *error)
{
	cau_mesh mesh;
	cau_status status = cau_mesh_make(def, "", &mesh, report, error);
	cau_mesh_finish(&mesh);
	if (status != CAU_BAD_MESH || wish->unit_m > 0 || !may_guess(report))
		return status;
	def->unit_m = report->proposed_unit_m;
	status = cau_mesh_make(def, "", &mesh, report, error);
	cau_mesh_finish(&mesh);
	report->unit_guessed = 1;
	return status;
}

// Gives each region its own material, up to CAU_MAX_MATERIALS, so that each can be changed
// separately.
static void add_materials(const cau_mesh_report *report, bool fat, cau_layer_def *layer)
{
	int32_t listed =
		report->region_count < CAU_MESH_REGION_MAX ? report->region_count : CAU_MESH_REGION_MAX;
	for (int32_t i = 0; i < listed && layer->material_count < CAU_MAX_MATERIALS; i++) {
		const cau_mesh_region *region = &report->region[i];
		if (region->dimension != (fat ? 3 : 2) || report->region_count < 2)
			continue;
		int32_t at = layer->material_count++;
		if (fat) {
			layer->fat[at] = layer->fat[0];
			layer->fat[at].region = region->region;
		} else {
			layer->sheet[at] = layer->sheet[0];
			layer->sheet[at].region = region->region;
		}
	}
}

static cau_status add_layers(const cau_mesh_wish *wish, const cau_mesh_report *report,
                             cau_scene_def *scene, cau_error *error)
{
	bool solid = report->tetrahedron_count > 0;
	bool fat = wish->layer_kind < 0 ? solid : wish->layer_kind == CAU_LAYER_FAT;
	if (fat && !solid)
		return cau_fail(error, CAU_BAD_MESH, "as",
		                "this file has a surface and no tetrahedra: use it as a sheet (as fascia), "
		                "or fill it with tetrahedra first (cautery-mesh)");
	if (!fat && !report->triangle_count)
		return cau_fail(error, CAU_BAD_MESH, "as",
		                "this file has tetrahedra and no triangles: use it as a solid (as fat)");
	cau_layer_def *layer = &scene->layers[scene->layer_count++];
	cau_default_layer_def(layer, fat ? CAU_LAYER_FAT : CAU_LAYER_FASCIA);
	snprintf(layer->name, sizeof layer->name, "%s", fat ? "fat" : "fascia");
	snprintf(layer->mesh, sizeof layer->mesh, "mesh");
	add_materials(report, fat, layer);
	if (!fat)
		return CAU_OK;
	cau_layer_def *membrane = &scene->layers[scene->layer_count++];
	cau_default_layer_def(membrane, CAU_LAYER_MEMBRANE);
	snprintf(membrane->name, sizeof membrane->name, "membrane");
	snprintf(membrane->of, sizeof membrane->of, "fat");
	return CAU_OK;
}

// Selects the outermost tenth of the mesh at one side.
static void pin_side(const cau_mesh_report *report, int axis, bool high, cau_selection *pin)
{
	double margin_m = 0.01 * longest_of(report);
	double width_m = report->most_m[axis] - report->least_m[axis];
	cau_default_selection(pin, CAU_SELECT_BOX);
	for (int c = 0; c < 3; c++) {
		pin->least_m[c] = report->least_m[c] - margin_m;
		pin->most_m[c] = report->most_m[c] + margin_m;
	}
	if (high)
		pin->least_m[axis] = report->most_m[axis] - 0.1 * width_m;
	else
		pin->most_m[axis] = report->least_m[axis] + 0.1 * width_m;
}

static cau_status pin_sides(const char *sides, const cau_mesh_report *report, cau_scene_def *scene,
                            cau_error *error)
{
	static const char *const names[] = {"left", "right", "front", "back", "bottom", "top"};
	for (const char *at = sides; *at;) {
		size_t length = strcspn(at, ","), side = 0;
		while (side < 6 && (strlen(names[side]) != length || memcmp(at, names[side], length) != 0))
			side++;
		bool none = length == 4 && memcmp(at, "none", 4) == 0;
		if (side == 6 && !none)
			return cau_fail(
				error, CAU_BAD_VALUE, "pin",
				"'%.*s' is not a side: use bottom, top, left, right, front, back or none",
				(int)(length < 40 ? length : 40), at);
		if (!none && scene->pin_count == CAU_MAX_PINS)
			return cau_fail(error, CAU_LIMIT, "pin", "more than %d sides", CAU_MAX_PINS);
		if (!none)
			pin_side(report, (int)(side / 2), side % 2, &scene->pins[scene->pin_count++]);
		at += length + (at[length] == ',');
	}
	return CAU_OK;
}

// Adds the wanted pins. By default pins the rim of an open sheet, and the lowest tenth of any other
// mesh.
static cau_status add_pins(const cau_mesh_wish *wish, const cau_mesh_report *report,
                           cau_scene_def *scene, cau_error *error)
{
	bool sheet = scene->layers[0].kind == CAU_LAYER_FASCIA;
	bool rim = sheet && report->open_edge_count && !report->tetrahedron_count;
	bool chosen = !wish->pins || !wish->pins[0];
	if (!chosen || !rim)
		return pin_sides(chosen ? "bottom" : wish->pins, report, scene, error);
	cau_selection *pin = &scene->pins[scene->pin_count++];
	cau_default_selection(pin, CAU_SELECT_RIM);
	snprintf(pin->layer, sizeof pin->layer, "fascia");
	return CAU_OK;
}

// Adds a ball and a grasper. The ball grows with the mesh's edges. An edge that is longer than the
// ball would stay cool at its ends and never part.
static void add_tools(const cau_mesh_report *report, cau_scene_def *scene)
{
	cau_tool_def *ball = &scene->tools[scene->tool_count++];
	cau_default_tool_def(ball, CAU_TOOL_SPHERE);
	snprintf(ball->name, sizeof ball->name, "ball");
	ball->hot_radius_m = fmin(fmax(ball->hot_radius_m, report->mean_edge_m), ball_radius_most_m);
	ball->grid_step_m = ball->hot_radius_m / 3;
	cau_tool_def *grasper = &scene->tools[scene->tool_count++];
	cau_default_tool_def(grasper, CAU_TOOL_GRASPER);
	snprintf(grasper->name, sizeof grasper->name, "grasper");
	double width_m = report->most_m[0] - report->least_m[0];
	for (int c = 0; c < 2; c++)
		ball->pose.position_m[c] = grasper->pose.position_m[c] =
			0.5 * (report->least_m[c] + report->most_m[c]);
	grasper->pose.position_m[0] += fmax(0.25 * width_m, tool_height_m);
	ball->pose.position_m[2] = grasper->pose.position_m[2] = report->most_m[2] + tool_height_m;
}

cau_status cau_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_mesh_report *report,
                          cau_error *error)
{
	CAU_ASSERT(wish->file != NULL, "a mesh of %zu bytes without a name", wish->byte_count);
	cau_default_scene_def(scene);
	// A mesh from a file was not made to part along its edges.
	scene->parting = CAU_PARTING_ELEMENTS;
	memset(scene->gravity_m_s2, 0, sizeof scene->gravity_m_s2);
	name_after_file(wish->file, scene->name);
	cau_status status = add_mesh(wish, scene, error);
	if (!status)
		status = read_report(wish, &scene->meshes[0], report, error);
	if (!status)
		status = add_layers(wish, report, scene, error);
	if (!status)
		status = add_pins(wish, report, scene, error);
	if (!status)
		add_tools(report, scene);
	return status;
}
