// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/stage.h"

#include <stdio.h>
#include <time.h>

#include "cautery/scene_json.h"
#include "core/rig/tier.h"

const double stage_absurd[STAGE_ABSURD_COUNT] = {NAN, INFINITY, -INFINITY, 1e300, -1e300};

static const double all_of_it_m = 100; // m, more than the size of any scene

static void expect_ok(cau_status status, const cau_error *error)
{
	if (status)
		fail_msg("%s: %s (%s)", cau_status_name(status), error->reason, error->path);
}

// ---- scenes
cau_scene_def *stage_scene(int precision)
{
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(scene);
	cau_default_scene_def(scene);
	strcpy(scene->name, "stage");
	scene->precision = precision;
	memset(scene->gravity_m_s2, 0, sizeof scene->gravity_m_s2);
	return scene;
}

static cau_scene_def *read_scene(const char *folder, const char *name)
{
	char path[512];
	snprintf(path, sizeof path, "%s/%s.json", folder, name);
	FILE *file = fopen(path, "rb");
	if (!file)
		fail_msg("cannot open %s", path);
	char *text = malloc(CAU_SCENE_JSON_MAX_BYTES);
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(text);
	assert_non_null(scene);
	size_t bytes = fread(text, 1, CAU_SCENE_JSON_MAX_BYTES, file);
	fclose(file);
	cau_error error = {0};
	expect_ok(cau_scene_from_json(path, text, bytes, scene, &error), &error);
	free(text);
	return scene;
}

cau_scene_def *stage_scene_named(const char *name)
{
	return read_scene(CAU_TEST_SCENES, name);
}

cau_scene_def *stage_scene_light(const char *name)
{
	return read_scene(CAU_TEST_LIGHT_SCENES, name);
}

static cau_layer_def *add_layer(cau_scene_def *scene, const char *name, int kind)
{
	assert_true(scene->layer_count < CAU_MAX_LAYERS);
	cau_layer_def *layer = &scene->layers[scene->layer_count++];
	cau_default_layer_def(layer, kind);
	snprintf(layer->name, sizeof layer->name, "%s", name);
	return layer;
}

static cau_mesh_def *add_mesh(cau_scene_def *scene, cau_layer_def *layer, int source)
{
	assert_true(scene->mesh_count < CAU_MAX_MESHES);
	cau_mesh_def *mesh = &scene->meshes[scene->mesh_count++];
	cau_default_mesh_def(mesh);
	mesh->source = source;
	snprintf(mesh->name, sizeof mesh->name, "mesh-%d", scene->mesh_count);
	memcpy(layer->mesh, mesh->name, sizeof layer->mesh);
	return mesh;
}

cau_layer_def *stage_add_sheet(cau_scene_def *scene, const char *name, double x_m, double y_m,
                               int32_t cells_x, int32_t cells_y)
{
	cau_layer_def *layer = add_layer(scene, name, CAU_LAYER_FASCIA);
	cau_mesh_def *mesh = add_mesh(scene, layer, CAU_MESH_SHEET);
	mesh->size_m[0] = x_m;
	mesh->size_m[1] = y_m;
	mesh->cells[0] = cells_x;
	mesh->cells[1] = cells_y;
	return layer;
}

void stage_add_taut_sheet(cau_scene_def *scene)
{
	cau_layer_def *fascia = stage_add_sheet(scene, "fascia", 0.06, 0.05, 30, 25);
	fascia->sheet[0].target[0] = fascia->sheet[0].target[1] = 0.4;
	cau_selection *rim = &scene->pins[scene->pin_count++];
	cau_default_selection(rim, CAU_SELECT_RIM);
	strcpy(rim->layer, "fascia");
}

cau_layer_def *stage_add_slab(cau_scene_def *scene, const char *name, const double size_m[3],
                              const int32_t cells[3])
{
	cau_layer_def *layer = add_layer(scene, name, CAU_LAYER_FAT);
	cau_mesh_def *mesh = add_mesh(scene, layer, CAU_MESH_SLAB);
	memcpy(mesh->size_m, size_m, sizeof mesh->size_m);
	memcpy(mesh->cells, cells, sizeof mesh->cells);
	return layer;
}

void stage_add_membrane(cau_scene_def *scene, const char *name, const char *of)
{
	cau_layer_def *layer = add_layer(scene, name, CAU_LAYER_MEMBRANE);
	snprintf(layer->of, sizeof layer->of, "%s", of);
}

cau_layer_def *stage_add_links(cau_scene_def *scene, const char *name, const char *of,
                               const char *to)
{
	cau_layer_def *layer = add_layer(scene, name, CAU_LAYER_LINKS);
	snprintf(layer->of, sizeof layer->of, "%s", of);
	snprintf(layer->to, sizeof layer->to, "%s", to);
	return layer;
}

cau_mesh_def *stage_mesh_of(cau_scene_def *scene, const cau_layer_def *layer)
{
	for (int32_t i = 0; i < scene->mesh_count; i++)
		if (!strcmp(scene->meshes[i].name, layer->mesh))
			return &scene->meshes[i];
	fail_msg("layer %s has no mesh", layer->name);
	return NULL;
}

cau_scene_def *stage_layered(void)
{
	const double size[3] = {0.04, 0.03, 0.01}, least[3] = {-1, -1, -0.0101},
				 most[3] = {1, 1, -0.0099};
	const int32_t cells[3] = {6, 5, 2};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	cau_layer_def *fascia = stage_add_sheet(scene, "fascia", 0.04, 0.03, 8, 6);
	stage_mesh_of(scene, fascia)->translate_m[2] = 0.002;
	stage_add_slab(scene, "fat", size, cells);
	stage_add_membrane(scene, "membrane", "fat");
	stage_add_links(scene, "links", "fascia", "membrane");
	stage_pin_box(scene, least, most);
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, 0, 0, 0.03);
	stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.01, 0, 0.02);
	return scene;
}

cau_selection stage_box(const double least_m[3], const double most_m[3])
{
	cau_selection box;
	cau_default_selection(&box, CAU_SELECT_BOX);
	memcpy(box.least_m, least_m, sizeof box.least_m);
	memcpy(box.most_m, most_m, sizeof box.most_m);
	return box;
}

cau_selection stage_everything(void)
{
	const double least[3] = {-all_of_it_m, -all_of_it_m, -all_of_it_m};
	const double most[3] = {all_of_it_m, all_of_it_m, all_of_it_m};
	return stage_box(least, most);
}

void stage_pin_box(cau_scene_def *scene, const double least_m[3], const double most_m[3])
{
	assert_true(scene->pin_count < CAU_MAX_PINS);
	scene->pins[scene->pin_count++] = stage_box(least_m, most_m);
}

cau_tool_def *stage_add_tool(cau_scene_def *scene, const char *name, int shape, double x, double y,
                             double z)
{
	assert_true(scene->tool_count < CAU_MAX_TOOLS);
	cau_tool_def *tool = &scene->tools[scene->tool_count++];
	cau_default_tool_def(tool, shape);
	snprintf(tool->name, sizeof tool->name, "%s", name);
	tool->pose.position_m[0] = x;
	tool->pose.position_m[1] = y;
	tool->pose.position_m[2] = z;
	return tool;
}

// ---- sessions
cau_session *stage_open(const cau_scene_def *scene, int32_t threads)
{
	cau_session_def def = cau_default_session_def();
	def.scene = scene;
	def.thread_count = threads;
	def.instruction_set = test_tier();
	cau_session *session = NULL;
	cau_error error = {0};
	expect_ok(cau_session_create(&def, &session, &error), &error);
	return session;
}

void stage_refuse(const cau_scene_def *scene, cau_status status, cau_error *error)
{
	cau_session_def def = cau_default_session_def();
	def.scene = scene;
	cau_session *session = NULL;
	*error = (cau_error){0};
	cau_status got = cau_session_create(&def, &session, error);
	if (got != status || !error->reason[0])
		fail_msg("%s (%s: %s) instead of %s", cau_status_name(got), error->path, error->reason,
		         cau_status_name(status));
	assert_null(session);
}

void stage_step(cau_session *session, int32_t ticks)
{
	cau_error error = {0};
	for (int32_t k = 0; k < ticks; k++)
		expect_ok(cau_session_step(session, &error), &error);
}

cau_frame stage_frame(const cau_session *session)
{
	cau_frame frame;
	cau_session_frame(session, &frame);
	return frame;
}

cau_session_info stage_info(const cau_session *session)
{
	cau_session_info info;
	cau_session_describe(session, &info);
	return info;
}

cau_balance stage_balance(cau_session *session)
{
	cau_balance balance;
	cau_session_balance(session, &balance);
	return balance;
}

const cau_tool_state *stage_tool(const cau_session *session, const char *name)
{
	cau_frame frame = stage_frame(session);
	for (int32_t i = 0; i < frame.tool_count; i++)
		if (!strcmp(frame.tools[i].name, name))
			return &frame.tools[i];
	fail_msg("there is no tool %s", name);
	return NULL;
}

// ---- commands
cau_command stage_command(int kind)
{
	cau_command command;
	cau_default_command(&command, kind);
	strcpy(command.tool, "hook");
	strcpy(command.as.material.layer, kind == CAU_COMMAND_SET_MATERIAL ? "fascia" : "");
	if (kind == CAU_COMMAND_TOOL_ADD || kind == CAU_COMMAND_TOOL_CONFIGURE)
		strcpy(command.as.definition.name, "other");
	return command;
}

void stage_submit(cau_session *session, const cau_command *command)
{
	cau_error error = {0};
	expect_ok(cau_session_submit(session, command, &error), &error);
}

static cau_command tool_command(int kind, const char *tool)
{
	cau_command command;
	cau_default_command(&command, kind);
	snprintf(command.tool, sizeof command.tool, "%s", tool);
	return command;
}

void stage_turn(cau_session *session, const char *tool, const cau_pose *pose)
{
	cau_command command = tool_command(CAU_COMMAND_TOOL_MOVE, tool);
	command.as.move.pose = *pose;
	command.as.move.jaw = 1;
	stage_submit(session, &command);
}

void stage_move(cau_session *session, const char *tool, double x, double y, double z)
{
	cau_pose pose = {.position_m = {x, y, z}, .rotation = {1, 0, 0, 0}};
	stage_turn(session, tool, &pose);
}

void stage_energize(cau_session *session, const char *tool, int on)
{
	cau_command command = tool_command(CAU_COMMAND_TOOL_ENERGIZE, tool);
	command.as.energized = on;
	stage_submit(session, &command);
}

void stage_grasp(cau_session *session, const char *tool)
{
	cau_command command = tool_command(CAU_COMMAND_TOOL_GRASP, tool);
	stage_submit(session, &command);
}

void stage_release(cau_session *session, const char *tool)
{
	cau_command command = tool_command(CAU_COMMAND_TOOL_RELEASE, tool);
	stage_submit(session, &command);
}

void stage_gravity(cau_session *session, double x, double y, double z)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_SET_GRAVITY);
	command.as.gravity_m_s2[0] = x;
	command.as.gravity_m_s2[1] = y;
	command.as.gravity_m_s2[2] = z;
	stage_submit(session, &command);
}

void stage_force(cau_session *session, cau_selection selection, double x, double y, double z)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_SET_FORCE);
	command.as.force.selection = selection;
	command.as.force.force_n[0] = x;
	command.as.force.force_n[1] = y;
	command.as.force.force_n[2] = z;
	stage_submit(session, &command);
}

enum { APPROACH_TICKS = 60 };

static double cut_length_m(const cau_cut_def *cut)
{
	return cau_length(cau_sub(cau_vec3_of(cut->to_m), cau_vec3_of(cut->from_m)));
}

int stage_cut_ticks(const cau_cut_def *cut, double step_s)
{
	return APPROACH_TICKS + (int)ceil((cut->dwell_s + cut_length_m(cut) / cut->speed_m_s) / step_s);
}

void stage_cut_tick(cau_session *session, const cau_cut_def *cut, const cau_pose *first, int tick)
{
	double step_s = stage_info(session).step_s, length = cut_length_m(cut);
	cau_pose start = {.rotation = {1, 0, 0, 0}};
	memcpy(start.position_m, cut->from_m, sizeof start.position_m);
	memcpy(start.rotation, cut->rotation, sizeof start.rotation);
	cau_pose pose = start;
	if (tick < APPROACH_TICKS) {
		pose = cau_pose_between(first, &start, (tick + 1.0) / APPROACH_TICKS);
	} else {
		double drawn = ((tick - APPROACH_TICKS) * step_s - cut->dwell_s) * cut->speed_m_s;
		double share = fmin(fmax(drawn, 0) / length, 1);
		for (int c = 0; c < 3; c++)
			pose.position_m[c] += share * (cut->to_m[c] - cut->from_m[c]);
	}
	if (tick == APPROACH_TICKS)
		stage_energize(session, cut->tool, 1);
	stage_turn(session, cut->tool, &pose);
}

// ---- numbers
double stage_mean_edge_m(const cau_session_info *info)
{
	double sum = 0;
	for (int32_t f = 0; f < info->face_count; f++)
		for (int k = 0; k < 3; k++) {
			const int32_t *v = info->face + 3 * (size_t)f;
			cau_vec3 a = cau_vec3_of(info->rest_position + 3 * (size_t)v[k]);
			cau_vec3 b = cau_vec3_of(info->rest_position + 3 * (size_t)v[(k + 1) % 3]);
			sum += cau_length(cau_sub(b, a));
		}
	return sum / (3.0 * info->face_count);
}

double stage_farthest(const cau_frame *frame, const double *from, int32_t vertex_count)
{
	double most = 0;
	for (size_t v = 0; v < (size_t)vertex_count; v++)
		most = fmax(most, cau_length(cau_sub(cau_vec3_of(frame->position + 3 * v),
		                                     cau_vec3_of(from + 3 * v))));
	return most;
}

double stage_seconds(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

stage_bytes stage_snapshot(const cau_session *session)
{
	stage_bytes shot = {.count = cau_session_snapshot_bytes(session)};
	shot.bytes = malloc(shot.count);
	assert_non_null(shot.bytes);
	cau_error error = {0};
	expect_ok(cau_session_snapshot(session, shot.bytes, shot.count, &shot.count, &error), &error);
	return shot;
}
