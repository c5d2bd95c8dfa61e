// SPDX-License-Identifier: GPL-3.0-or-later
// Finds and reads scenes: by name in a folder, from a file, or made around a mesh file.
#include "sim/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/embed.h"
#include "cautery/mesh_scene.h"
#include "cautery/name.h"
#include "cautery/session.h"
#include "places/places.h"

// ---- scenes around mesh files, with motions that give a first cut and pull
// The measures of a tissue that the scene's motions need.
typedef struct extent {
	double least[3], most[3]; // bounding box, m
	double from_z, to_z;      // height of the surface at both ends of the cut, m
} extent;

static const double cut_share = 0.3; // half length of the cut, as a share of the longer extent

static int longer_axis(const extent *e)
{
	return e->most[1] - e->least[1] > e->most[0] - e->least[0] ? 1 : 0;
}

// Sets x and y of the cut's end on the given side; z stays.
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

// Returns the height of the highest vertex whose distance from the point is within 5 % of the
// extent. If there is none, returns the height of the box.
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

static void add_motions(const extent *e, cau_scene_def *scene)
{
	cau_cut_def *cut = &scene->cut;
	cut->present = 1;
	snprintf(cut->tool, sizeof cut->tool, "%s", scene->tools[0].name);
	cut_end(e, -1.0, cut->from_m);
	cut_end(e, 1.0, cut->to_m);
	cut->from_m[2] = e->from_z;
	cut->to_m[2] = e->to_z;

	// At this speed the ball is over each point for three seconds, which is enough for the default
	// ignition temperatures.
	cau_tool_def *ball = &scene->tools[0];
	memcpy(ball->pose.position_m, cut->from_m, sizeof cut->from_m);
	ball->pose.position_m[2] = e->most[2] + 0.05;
	cut->speed_m_s = ball->hot_radius_m * 2.0 / 3.0;

	cau_pull_def *pull = &scene->pull;
	pull->present = 1;
	cau_default_selection(&pull->selection, CAU_SELECT_SPHERE);
	for (int a = 0; a < 3; a++)
		pull->selection.center_m[a] = 0.5 * (cut->from_m[a] + cut->to_m[a]);
	pull->selection.radius_m = 0.1 * (e->most[longer_axis(e)] - e->least[longer_axis(e)]);
}

// Makes the scene's tissue and measures it.
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
	measure_box(&info, e);
	double from[3], to[3];
	cut_end(e, -1.0, from);
	cut_end(e, 1.0, to);
	e->from_z = surface_height(&info, e, from);
	e->to_z = surface_height(&info, e, to);
	cau_session_destroy(session);
	return CAU_OK;
}

// Replaces names of the wire protocol in `text` by names of the options.
static void use_own_words(char *text, size_t bytes)
{
	static const char *const words[][2] = {{"unit_m", "--unit-m"},
	                                       {"strict refuses", "--strict refuses"}};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		char rest[CAU_MESH_TEXT_BYTES];
		char *at = strstr(text, words[i][0]);
		if (!at)
			continue;
		snprintf(rest, sizeof rest, "%s", at + strlen(words[i][0]));
		snprintf(at, bytes - (size_t)(at - text), "%s%s", words[i][1], rest);
	}
}

// Rewrites an error in the words of the options. The user wrote no scene, so paths into a scene
// mean nothing.
static cau_status in_own_words(const char *file, cau_status status, cau_error *error)
{
	if (!error)
		return status;
	error->path[0] = 0;
	snprintf(error->file, sizeof error->file, "%.255s", file);
	use_own_words(error->reason, sizeof error->reason);
	return status;
}

cau_status sim_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_error *error)
{
	extent e;
	cau_mesh_report report = {0};
	char text[CAU_MESH_TEXT_BYTES];
	cau_status status = cau_mesh_scene(wish, scene, &report, error);
	if (status)
		return in_own_words(wish->file, status, error);
	cau_mesh_report_text(&report, text);
	use_own_words(text, sizeof text);
	fprintf(stderr, "cautery-sim: %s\n%s", wish->file, text);
	status = probe(scene, &e, error);
	if (status)
		return in_own_words(wish->file, status, error);
	add_motions(&e, scene);
	return CAU_OK;
}

// ---- finding and reading scenes
enum { PATH_BYTES = 1024 };

static bool ends_with(const char *text, const char *ending)
{
	size_t bytes = strlen(text), tail = strlen(ending);
	return bytes >= tail && strcmp(text + bytes - tail, ending) == 0;
}

static cau_status load_name(const char *name, const char *folder, cau_scene_def *scene,
                            cau_error *error)
{
	char path[PATH_BYTES], installed[PATH_BYTES];
	if (strlen(name) >= CAU_NAME_BYTES || !cau_name_is_valid(name))
		return cau_fail(error, CAU_BAD_VALUE, NULL,
		                "\"%.100s\" is neither the name of a scene (%s) nor a file", name,
		                CAU_NAME_RULE);
	if (!folder && !cau_place_find("scenes", installed, sizeof installed))
		return cau_fail(
			error, CAU_NOT_FOUND, NULL,
			"the folder ../share/cautery/scenes beside this program is missing: give --scenes DIR");
	if (!folder)
		folder = installed;
	int bytes = snprintf(path, sizeof path, "%s/%s.json", folder, name);
	if (bytes < 0 || (size_t)bytes >= sizeof path)
		return cau_fail(
			error, CAU_LIMIT, NULL,
			"the path of scene \"%s\" is longer than %d bytes: give a shorter --scenes DIR", name,
			PATH_BYTES - 1);
	if (access(path, F_OK) != 0)
		return cau_fail(error, CAU_NOT_FOUND, NULL, "no scene \"%s\" in %s", name, folder);
	return cau_scene_from_file(path, scene, error);
}

cau_status sim_scene_load(const char *source, const char *folder, double unit_m, bool strict,
                          cau_scene_def *scene, cau_error *error)
{
	struct stat about;
	if (ends_with(source, ".json"))
		return cau_scene_from_file(source, scene, error);
	if (stat(source, &about) == 0 && S_ISREG(about.st_mode))
		return sim_mesh_scene(
			&(cau_mesh_wish){.file = source, .unit_m = unit_m, .strict = strict, .layer_kind = -1},
			scene, error);
	return load_name(source, folder, scene, error);
}
