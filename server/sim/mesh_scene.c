// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/mesh_scene.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/mesh_scene.h"
#include "cautery/session.h"

// What a scene around a mesh must know of it.
typedef struct extent {
	double least[3], most[3]; // m
	double from_z, to_z;      // m, height of the surface at the ends of the cut
	double edge_m;            // mean length of the faces' edges
	bool has_rim;             // an edge with one triangle only
} extent;

static const double cut_share = 0.3; // of the longer extent, to each side of the middle

static int longer_axis(const extent *e)
{
	return e->most[1] - e->least[1] > e->most[0] - e->least[0] ? 1 : 0;
}

// The end of the cut on the given side, in the plane; z is left alone.
static void cut_end(const extent *e, double side, double point[3])
{
	int axis = longer_axis(e);
	for (int i = 0; i < 2; i++)
		point[i] = 0.5 * (e->least[i] + e->most[i]);
	point[axis] += side * cut_share * (e->most[axis] - e->least[axis]);
}

static void measure_box(const cau_session_info *info, extent *e)
{
	for (int a = 0; a < 3; a++) {
		e->least[a] = INFINITY;
		e->most[a] = -INFINITY;
		for (int32_t i = 0; i < info->vertex_count; i++) {
			e->least[a] = fmin(e->least[a], info->rest_position[3 * (size_t)i + (size_t)a]);
			e->most[a] = fmax(e->most[a], info->rest_position[3 * (size_t)i + (size_t)a]);
		}
	}
}

// Height of the highest vertex within 5 % of the extent of the point; of the box where there is
// none.
static double surface_height(const cau_session_info *info, const extent *e, const double point[3])
{
	double reach = 0.05 * hypot(e->most[0] - e->least[0], e->most[1] - e->least[1]);
	double height = -INFINITY;
	for (int32_t i = 0; i < info->vertex_count; i++) {
		const double *x = info->rest_position + 3 * (size_t)i;
		if (hypot(x[0] - point[0], x[1] - point[1]) <= reach)
			height = fmax(height, x[2]);
	}
	return isfinite(height) ? height : e->most[2];
}

static int compare_edges(const void *a, const void *b)
{
	return memcmp(a, b, 2 * sizeof(int32_t));
}

static double edge_length(const cau_session_info *info, const int32_t edge[2])
{
	const double *a = info->rest_position + 3 * (size_t)edge[0];
	const double *b = info->rest_position + 3 * (size_t)edge[1];
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static cau_status measure_edges(const cau_session_info *info, extent *e, cau_error *error)
{
	double sum_m = 0.0;
	size_t count = 3 * (size_t)info->face_count;
	int32_t(*edge)[2] = malloc((count + 1) * sizeof *edge);
	if (!edge)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %zu edges", count);
	for (size_t i = 0; i < count; i++) {
		int32_t a = info->face[i], b = info->face[i % 3 == 2 ? i - 2 : i + 1];
		edge[i][0] = a < b ? a : b;
		edge[i][1] = a < b ? b : a;
		sum_m += edge_length(info, edge[i]);
	}
	e->edge_m = count > 0 ? sum_m / (double)count : 0.0;
	qsort(edge, count, sizeof *edge, compare_edges);
	e->has_rim = false;
	for (size_t i = 0, next; i < count && !e->has_rim; i = next) {
		for (next = i + 1; next < count && compare_edges(edge[i], edge[next]) == 0;)
			next++;
		e->has_rim = next == i + 1;
	}
	free(edge);
	return CAU_OK;
}

static void name_after_file(const char *file, char name[CAU_NAME_BYTES])
{
	const char *slash = strrchr(file, '/');
	size_t used = 0;
	bool word = false; // the last byte ends a word
	for (const char *at = slash ? slash + 1 : file; *at && *at != '.' && used < CAU_NAME_BYTES - 1;
	     at++) {
		bool upper = *at >= 'A' && *at <= 'Z';
		char c = upper ? (char)(*at - 'A' + 'a') : *at;
		bool letter = c >= 'a' && c <= 'z', digit = c >= '0' && c <= '9';
		if (letter || (digit && used > 0))
			name[used++] = c;
		else if (word)
			name[used++] = '-';
		word = used > 0 && name[used - 1] != '-';
	}
	while (used > 0 && name[used - 1] == '-')
		used--;
	name[used] = 0;
	if (used == 0)
		snprintf(name, CAU_NAME_BYTES, "mesh");
}

static cau_status start_scene(const char *file, double unit_m, bool tetrahedra,
                              cau_scene_def *scene, cau_error *error)
{
	cau_default_scene_def(scene);
	scene->parting = CAU_PARTING_ELEMENTS;
	// A scanned organ has its shape under its weight already: gravity would count twice.
	memset(scene->gravity_m_s2, 0, sizeof scene->gravity_m_s2);
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
	cau_default_layer_def(layer, tetrahedra ? CAU_LAYER_FAT : CAU_LAYER_FASCIA);
	snprintf(layer->name, sizeof layer->name, tetrahedra ? "fat" : "fascia");
	snprintf(layer->mesh, sizeof layer->mesh, "mesh");
	if (tetrahedra) {
		cau_layer_def *membrane = &scene->layers[scene->layer_count++];
		cau_default_layer_def(membrane, CAU_LAYER_MEMBRANE);
		snprintf(membrane->name, sizeof membrane->name, "membrane");
		snprintf(membrane->of, sizeof membrane->of, "fat");
	}
	return CAU_OK;
}

// The lowest tenth is pinned, or the rim.
static void add_pins(const extent *e, bool rim, cau_scene_def *scene)
{
	cau_selection *pin = &scene->pins[scene->pin_count++];
	cau_default_selection(pin, rim ? CAU_SELECT_RIM : CAU_SELECT_BOX);
	if (rim) {
		snprintf(pin->layer, sizeof pin->layer, "fascia");
		return;
	}
	double height = e->most[2] - e->least[2];
	for (int a = 0; a < 3; a++) {
		pin->least_m[a] = e->least[a] - 1e-3;
		pin->most_m[a] = e->most[a] + 1e-3;
	}
	pin->most_m[2] = e->least[2] + 0.1 * height;
}

// The ball grows with the mesh: an edge that sticks out of it on both sides stays cool at its ends
// and never parts. Three seconds inside suffice for the default ignition temperatures.
static void add_tool(const extent *e, cau_scene_def *scene)
{
	cau_tool_def *tool = &scene->tools[scene->tool_count++];
	cau_default_tool_def(tool, CAU_TOOL_SPHERE);
	snprintf(tool->name, sizeof tool->name, "ball");
	tool->hot_radius_m = fmin(fmax(tool->hot_radius_m, e->edge_m), 0.03);
	tool->grid_step_m = tool->hot_radius_m / 3.0;
	memcpy(tool->pose.position_m, scene->cut.from_m, sizeof scene->cut.from_m);
	tool->pose.position_m[2] = e->most[2] + 0.05;
	scene->cut.speed_m_s = tool->hot_radius_m * 2.0 / 3.0;
}

static void add_motions(const extent *e, cau_scene_def *scene)
{
	cau_cut_def *cut = &scene->cut;
	cut->present = 1;
	snprintf(cut->tool, sizeof cut->tool, "ball");
	cut_end(e, -1.0, cut->from_m);
	cut_end(e, 1.0, cut->to_m);
	cut->from_m[2] = e->from_z;
	cut->to_m[2] = e->to_z;

	add_tool(e, scene);

	cau_pull_def *pull = &scene->pull;
	pull->present = 1;
	cau_default_selection(&pull->selection, CAU_SELECT_SPHERE);
	for (int a = 0; a < 3; a++)
		pull->selection.center_m[a] = 0.5 * (cut->from_m[a] + cut->to_m[a]);
	pull->selection.radius_m = 0.1 * (e->most[longer_axis(e)] - e->least[longer_axis(e)]);
}

static void print_report(const char *file, const cau_mesh_report *report)
{
	char text[CAU_MESH_TEXT_BYTES];
	if (!report)
		return;
	cau_mesh_report_text(report, text);
	fprintf(stderr, "cautery-sim: %s\n%s", file, text);
}

// Loads the scene so far and measures its mesh.
static cau_status probe(const cau_scene_def *scene, extent *e, cau_error *error)
{
	cau_session_def def = cau_default_session_def();
	cau_session *session;
	cau_session_info info;
	def.scene = scene;
	cau_status status = cau_session_create(&def, &session, error);
	if (status)
		return status;
	cau_session_describe(session, &info);
	print_report(scene->meshes[0].file, info.mesh_report);
	measure_box(&info, e);
	double from[3], to[3];
	cut_end(e, -1.0, from);
	cut_end(e, 1.0, to);
	e->from_z = surface_height(&info, e, from);
	e->to_z = surface_height(&info, e, to);
	status = measure_edges(&info, e, error);
	cau_session_destroy(session);
	return status;
}

// The user wrote no scene that a path could point into, and knows units as an option.
static cau_status in_own_words(const char *file, cau_status status, cau_error *error)
{
	char *at = error ? strstr(error->reason, "(unit_m ") : NULL;
	if (!error)
		return status;
	error->path[0] = 0;
	snprintf(error->file, sizeof error->file, "%.255s", file);
	if (at && strlen(error->reason) + 3 < sizeof error->reason) {
		memmove(at + 3, at + 1, strlen(at + 1) + 1);
		memcpy(at, "(--unit-m", 9);
	}
	return status;
}

cau_status sim_mesh_scene(const char *file, double unit_m, cau_scene_def *scene, cau_error *error)
{
	extent e;
	bool tetrahedra = true;
	cau_status status = start_scene(file, unit_m, true, scene, error);
	if (!status)
		status = probe(scene, &e, error);
	if (status == CAU_BAD_MESH || status == CAU_BAD_VALUE) { // perhaps a mesh of triangles only
		tetrahedra = false;
		status = start_scene(file, unit_m, false, scene, error);
		if (!status)
			status = probe(scene, &e, error);
	}
	if (status)
		return in_own_words(file, status, error);
	add_pins(&e, !tetrahedra && e.has_rim, scene);
	add_motions(&e, scene);
	return CAU_OK;
}
