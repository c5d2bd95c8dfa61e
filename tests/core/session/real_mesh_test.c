// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes from other sources load, and are cut for ten simulated seconds without a fault. Skipped if
// the folder CAUTERY_MESHES is absent.
#include "core/session/stage.h"

#include <dirent.h>
#include <stdio.h>

#include "session/session_internal.h"

static const double cut_s = 10;
// Size, m, to which the mesh is scaled, whatever the file's unit is.
static const double wanted_size_m = 0.12;

static int has_ending(const char *name, const char *ending)
{
	size_t length = strlen(name), end = strlen(ending);
	return length > end && !strcmp(name + length - end, ending);
}

// Returns a scene of this file in this unit: a sheet, or fat with its membrane.
static cau_scene_def *scene_of(const char *folder, const char *file, double unit_m, int kind)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	if (kind == CAU_LAYER_FAT) // a hollow sheet would collapse, away from the tool
		cau_default_gravity(scene->gravity_m_s2);
	snprintf(scene->directory, sizeof scene->directory, "%s", folder);
	cau_layer_def *layer = stage_add_sheet(scene, "body", 1, 1, 1, 1);
	cau_mesh_def *mesh = stage_mesh_of(scene, layer);
	char mesh_name[CAU_NAME_BYTES];
	memcpy(mesh_name, mesh->name, sizeof mesh_name);
	cau_default_layer_def(layer, kind);
	strcpy(layer->name, "body");
	memcpy(layer->mesh, mesh_name, sizeof layer->mesh);
	mesh->source = CAU_MESH_FILE;
	snprintf(mesh->file, sizeof mesh->file, "%s", file);
	mesh->unit_m = unit_m;
	layer->sheet[0].heat.absorption_per_s = layer->fat[0].heat.absorption_per_s = 20;
	layer->sheet[0].shrink[0] = layer->fat[0].shrink[0] = 0.3;
	if (kind == CAU_LAYER_FAT) {
		stage_add_membrane(scene, "membrane", "body");
		scene->layers[1].sheet[0].heat.absorption_per_s = 20;
	}
	return scene;
}

typedef struct extent {
	double least[3], most[3], size;
} extent;

static extent extent_of(const cau_session_info *info)
{
	extent e = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};
	for (size_t i = 0; i < 3 * (size_t)info->vertex_count; i++) {
		e.least[i % 3] = fmin(e.least[i % 3], info->rest_position[i]);
		e.most[i % 3] = fmax(e.most[i % 3], info->rest_position[i]);
	}
	for (int c = 0; c < 3; c++)
		e.size = fmax(e.size, e.most[c] - e.least[c]);
	return e;
}

// Pins the lowest tenth, and moves a hot ball through the middle from side to side and back.
static void cut(cau_session *session, const extent *e, const char *file)
{
	cau_session_info info = stage_info(session);
	int ticks = (int)(cut_s / info.step_s);
	cau_command add;
	cau_default_command(&add, CAU_COMMAND_TOOL_ADD);
	add.as.definition.shape = CAU_TOOL_SPHERE;
	add.as.definition.hot_radius_m = 0.006;
	strcpy(add.as.definition.name, "ball");
	for (int c = 0; c < 3; c++)
		add.as.definition.pose.position_m[c] = (e->least[c] + e->most[c]) / 2;
	add.as.definition.pose.position_m[0] = e->least[0] - 0.02;
	stage_submit(session, &add);
	stage_step(session, 1);
	stage_energize(session, "ball", 1);
	double started = stage_seconds();
	for (int tick = 0; tick < ticks; tick++) {
		double s = 2.0 * tick / ticks, across = s < 1 ? s : 2 - s;
		stage_move(session, "ball", e->least[0] + across * (e->most[0] - e->least[0]),
		           (e->least[1] + e->most[1]) / 2 + 0.02 * sin(12 * s),
		           (e->least[2] + e->most[2]) / 2);
		stage_step(session, 1);
	}
	cau_frame frame = stage_frame(session);
	print_message("%s: %d vertices, %d triangles, %d tetrahedra; %d elements removed, %d inverted; "
	              "%.1f s\n",
	              file, info.vertex_count, info.triangle_count, info.tetrahedron_count,
	              frame.statistics.elements_removed, frame.statistics.inverted,
	              stage_seconds() - started);
	assert_true(frame.statistics.elements_removed > 0);
	for (int32_t i = 0; i < 3 * info.vertex_count; i++)
		assert_true(isfinite(frame.position[i]));
}

static void load_and_cut(const char *folder, const char *file)
{
	int kind = has_ending(file, ".obj") ? CAU_LAYER_FASCIA : CAU_LAYER_FAT;
	cau_scene_def *scene = scene_of(folder, file, 1e-3, kind);
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	extent e = extent_of(&info);
	scene->meshes[0].unit_m *= wanted_size_m / e.size;
	cau_session_destroy(session);
	session = stage_open(scene, 1);
	info = stage_info(session);
	e = extent_of(&info);
	cau_session_destroy(session);
	double most[3] = {1, 1, e.least[2] + 0.1 * (e.most[2] - e.least[2])}, least[3] = {-1, -1, -1};
	stage_pin_box(scene, least, most);
	session = stage_open(scene, 1);
	cut(session, &e, file);
	cau_session_destroy(session);
	free(scene);
}

static void every_file_loads_and_is_cut(void **state)
{
	const char *path = *state;
	DIR *folder = opendir(path);
	int count = 0;
	for (struct dirent *entry; (entry = readdir(folder));)
		if (has_ending(entry->d_name, ".msh") || has_ending(entry->d_name, ".obj") ||
		    has_ending(entry->d_name, ".vtk")) {
			load_and_cut(path, entry->d_name);
			count++;
		}
	closedir(folder);
	assert_true(count > 0);
}

int main(void)
{
	char *path = getenv("CAUTERY_MESHES");
	DIR *folder = path && path[0] ? opendir(path) : NULL;
	if (!folder) {
		printf("skipped: CAUTERY_MESHES names no folder of meshes\n");
		return 77;
	}
	closedir(folder);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(every_file_loads_and_is_cut, path),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
