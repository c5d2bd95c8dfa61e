// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/mesh_scene.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "mesh/mesh.h"

// From 3 to 20 units only centimetres make an organ: 3 to 20 cm, where millimetres make 3 to 20 mm.
// Beyond that both may, and the user is asked.
static const double centimetres_most = 20;
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

// Reads the mesh for its report. Where no unit was said, and metres make no tissue but centimetres
// make an organ, these are taken.
static cau_status read_report(const cau_mesh_wish *wish, cau_mesh_def *def, cau_mesh_report *report,
                              cau_error *error)
{
	cau_mesh mesh;
	cau_status status = cau_mesh_make(def, "", &mesh, report, error);
	cau_mesh_finish(&mesh);
	bool centimetres = status == CAU_BAD_MESH && report->proposed_unit_m == 0.01 &&
	                   !(wish->unit_m > 0) && longest_of(report) <= centimetres_most;
	if (!centimetres)
		return status;
	def->unit_m = report->proposed_unit_m;
	status = cau_mesh_make(def, "", &mesh, report, error);
	cau_mesh_finish(&mesh);
	report->unit_guessed = 1;
	return status;
}

static cau_status add_layers(const cau_mesh_wish *wish, const cau_mesh_report *report,
                             cau_scene_def *scene, cau_error *error)
{
	bool solid = report->tetrahedron_count > 0;
	bool fat = wish->layer_kind < 0 ? solid : wish->layer_kind == CAU_LAYER_FAT;
	if (fat && !solid)
		return cau_fail(
			error, CAU_BAD_MESH, "as",
			"this file has a surface and no tetrahedra: make a sheet of it (as fascia), "
			"or fill it with tetrahedra first, as TetGen and gmsh -3 do");
	if (!fat && !report->triangle_count)
		return cau_fail(error, CAU_BAD_MESH, "as",
		                "this file has tetrahedra and no triangles: make a solid of it (as fat)");
	cau_layer_def *layer = &scene->layers[scene->layer_count++];
	cau_default_layer_def(layer, fat ? CAU_LAYER_FAT : CAU_LAYER_FASCIA);
	snprintf(layer->name, sizeof layer->name, "%s", fat ? "fat" : "fascia");
	snprintf(layer->mesh, sizeof layer->mesh, "mesh");
	if (!fat)
		return CAU_OK;
	cau_layer_def *membrane = &scene->layers[scene->layer_count++];
	cau_default_layer_def(membrane, CAU_LAYER_MEMBRANE);
	snprintf(membrane->name, sizeof membrane->name, "membrane");
	snprintf(membrane->of, sizeof membrane->of, "fat");
	return CAU_OK;
}

// The lowest tenth, or the rim of an open sheet.
static void add_pins(const cau_mesh_report *report, cau_scene_def *scene)
{
	bool sheet = scene->layers[0].kind == CAU_LAYER_FASCIA;
	bool rim = sheet && report->open_edge_count && !report->tetrahedron_count;
	double margin_m = 0.01 * longest_of(report);
	cau_selection *pin = &scene->pins[scene->pin_count++];
	cau_default_selection(pin, rim ? CAU_SELECT_RIM : CAU_SELECT_BOX);
	snprintf(pin->layer, sizeof pin->layer, "%s", rim ? "fascia" : "");
	for (int c = 0; c < 3 && !rim; c++) {
		pin->least_m[c] = report->least_m[c] - margin_m;
		pin->most_m[c] = report->most_m[c] + margin_m;
	}
	if (!rim)
		pin->most_m[2] = report->least_m[2] + 0.1 * (report->most_m[2] - report->least_m[2]);
}

// The ball grows with the mesh: an edge that sticks out of it on both sides stays cool at its ends
// and never parts.
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
	scene->parting = CAU_PARTING_ELEMENTS; // whoever made the mesh did not make it for its edges
	memset(scene->gravity_m_s2, 0, sizeof scene->gravity_m_s2);
	name_after_file(wish->file, scene->name);
	cau_status status = add_mesh(wish, scene, error);
	if (!status)
		status = read_report(wish, &scene->meshes[0], report, error);
	if (!status)
		status = add_layers(wish, report, scene, error);
	if (status)
		return status;
	add_pins(report, scene);
	add_tools(report, scene);
	return CAU_OK;
}
