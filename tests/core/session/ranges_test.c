// SPDX-License-Identifier: GPL-3.0-or-later
// Documented ranges are enforced. Pages and schemas are generated from the parameter tables of
// scenes and commands. Each entry is tested at both ends of its range and at the next number
// beyond, first through JSON and then in the core.
#include "core/session/stage.h"

#include "cautery/command_json.h"
#include "cautery/defaults.h"
#include "cautery/scene_json.h"
#include "session/session_internal.h"
#include "json/document.h"

enum { TEXT_BYTES = CAU_SCENE_JSON_MAX_BYTES };

static int tried;
static char text[TEXT_BYTES];

// ---- one value of one field
static void poke(const cau_field *field, void *base, int32_t component, double value)
{
	char *at = (char *)base + field->offset;
	if (field->type == CAU_FIELD_INTEGER)
		memcpy(at + (size_t)component * sizeof(int32_t), &(int32_t){(int32_t)value},
		       sizeof(int32_t));
	else
		memcpy(at + (size_t)component * sizeof value, &value, sizeof value);
}

static double beyond(const cau_field *field, double end, double sign)
{
	if (field->type == CAU_FIELD_INTEGER)
		return end + sign;
	return nextafter(end, sign * INFINITY);
}

static bool has_range(const cau_field *field, int kind)
{
	return (field->type == CAU_FIELD_NUMBER || field->type == CAU_FIELD_INTEGER) &&
	       cau_field_applies(field, kind);
}

// ---- scenes
static cau_status read_and_check(const cau_scene_def *scene, cau_error *error)
{
	size_t bytes = 0;
	cau_scene_def *read = malloc(sizeof *read);
	assert_non_null(read);
	cau_status status = cau_scene_to_json(scene, text, sizeof text, &bytes, error);
	if (!status)
		status = cau_scene_from_json("", text, bytes, read, error);
	if (!status)
		status = cau_scene_check(read, error);
	free(read);
	return status;
}

// The text of some entries states a relation to a second number. This function sets the second
// number so that both ends of the field's range are valid.
static void make_way(cau_tool_def *tool, const cau_field *field)
{
	if (strcmp(field->name, "hot_radius_m") == 0)
		tool->grid_step_m = 5e-5; // "at most the smallest radius of the hot part"
	if (strcmp(field->name, "grid_step_m") == 0)
		tool->hot_radius_m = 0.05;
	if (strcmp(field->name, "grid_step_m") == 0 || strcmp(field->name, "hot_radius_m") == 0)
		tool->diffusivity_m2_s = 1e-8; // the heat grid takes at most 64 substeps in a tick
	if (strcmp(field->name, "diffusivity_m2_s") == 0) {
		tool->hot_radius_m = 0.05;
		tool->grid_step_m = 0.01;
	}
}

// True if the text of the table, quoted below, restricts the range of this field further.
static bool is_word_bound(const cau_field *field, double value)
{
	bool definite = strcmp(field->name, "target") == 0;            // "positive definite"
	bool fan = strcmp(field->name, "cells") == 0 && value < 3;     // "of a pattern, 3 at least"
	bool region = strcmp(field->name, "region") == 0 && value > 0; // "of the layer's mesh"
	return definite || fan || region;
}

static void try_scene_value(cau_scene_def *scene, const cau_field *field, void *base, int32_t c,
                            double value, bool accepted)
{
	cau_error error = {0};
	cau_scene_def *kept = malloc(sizeof *kept);
	assert_non_null(kept);
	*kept = *scene;
	poke(field, base, c, value);
	make_way(&scene->tools[0], field);
	cau_status status = read_and_check(scene, &error);
	bool word = status && is_word_bound(field, value) && strstr(error.path, field->name);
	if (accepted && status && !word)
		fail_msg("%s[%d] = %g is documented and refused: %s: %s", field->name, c, value, error.path,
		         error.reason);
	if (!accepted && !status)
		fail_msg("%s[%d] = %.17g is beyond its range and accepted", field->name, c, value);
	*scene = *kept;
	free(kept);
	tried++;
}

static void try_scene_part(cau_scene_def *scene, const cau_record *record, void *base, int kind)
{
	for (int f = 0; f < record->field_count; f++) {
		const cau_field *field = &record->fields[f];
		for (int32_t c = 0; has_range(field, kind) && c < (field->count ? field->count : 1); c++) {
			try_scene_value(scene, field, base, c, field->least, true);
			try_scene_value(scene, field, base, c, field->most, true);
			if (field->most < INT32_MAX)
				try_scene_value(scene, field, base, c, beyond(field, field->most, 1), false);
			try_scene_value(scene, field, base, c, beyond(field, field->least, -1), false);
		}
	}
}

static void try_material(cau_scene_def *scene, cau_layer_def *layer)
{
	cau_part parts[2];
	int count =
		cau_material_parts(layer->kind, &layer->sheet[0], &layer->fat[0], &layer->link, parts);
	for (int i = 0; i < count; i++)
		try_scene_part(scene, parts[i].record, parts[i].base, parts[i].kind);
}

static void every_row_of_a_scene(void **state)
{
	(void)state;
	tried = 0;
	cau_scene_def *scene = stage_layered();
	try_scene_part(scene, &cau_scene_record, scene, 0);
	for (int32_t i = 0; i < scene->mesh_count; i++)
		try_scene_part(scene, &cau_mesh_record, &scene->meshes[i], scene->meshes[i].source);
	for (int32_t i = 0; i < scene->layer_count; i++) {
		try_scene_part(scene, &cau_layer_record, &scene->layers[i], scene->layers[i].kind);
		try_material(scene, &scene->layers[i]);
	}
	for (int kind = 0; kind < CAU_SELECT_COUNT; kind++) {
		scene->pin_count = 1;
		cau_default_selection(&scene->pins[0], kind);
		try_scene_part(scene, &cau_selection_record, &scene->pins[0], kind);
	}
	for (int shape = 0; shape < CAU_TOOL_SHAPE_COUNT; shape++) {
		scene->tools[0].shape = shape;
		try_scene_part(scene, &cau_tool_record, &scene->tools[0], 0);
		try_scene_part(scene, &cau_pose_record, &scene->tools[0].pose, 0);
	}
	scene->pull.present = scene->cut.present = 1;
	cau_default_selection(&scene->pull.selection, CAU_SELECT_NEAREST);
	memcpy(scene->cut.tool, scene->tools[0].name, sizeof scene->cut.tool);
	try_scene_part(scene, &cau_pull_record, &scene->pull, 0);
	try_scene_part(scene, &cau_cut_record, &scene->cut, 0);
	assert_true(tried > 1000);
	free(scene);
}

// ---- commands
static cau_status read_and_submit(cau_session *session, const cau_command *command,
                                  cau_error *error)
{
	size_t bytes = 0;
	static cau_command read;
	cau_status status = cau_command_to_json(command, text, sizeof text, &bytes, error);
	if (!status)
		status = cau_command_from_json(text, bytes, &read, error);
	if (!status)
		status = cau_session_submit(session, &read, error);
	if (!status)
		session->queue.count = 0; // the test needs only whether the command is accepted
	return status;
}

static void try_command_value(cau_session *session, cau_command *command, const cau_field *field,
                              void *base, int32_t c, double value, bool accepted)
{
	cau_error error = {0};
	static cau_command kept;
	kept = *command;
	poke(field, base, c, value);
	if (command->kind == CAU_COMMAND_TOOL_ADD || command->kind == CAU_COMMAND_TOOL_CONFIGURE)
		make_way(&command->as.definition, field);
	cau_status status = read_and_submit(session, command, &error);
	bool word = status && is_word_bound(field, value) && strstr(error.path, field->name);
	if (accepted && status && !word)
		fail_msg("command %d: %s[%d] = %g is documented and refused: %s: %s", command->kind,
		         field->name, c, value, error.path, error.reason);
	if (!accepted && !status)
		fail_msg("command %d: %s[%d] = %.17g is beyond its range and accepted", command->kind,
		         field->name, c, value);
	*command = kept;
	tried++;
}

static void try_command_part(cau_session *session, cau_command *command, const cau_record *record,
                             void *base, int kind)
{
	for (int f = 0; f < record->field_count; f++) {
		const cau_field *field = &record->fields[f];
		for (int32_t c = 0; has_range(field, kind) && c < (field->count ? field->count : 1); c++) {
			try_command_value(session, command, field, base, c, field->least, true);
			try_command_value(session, command, field, base, c, field->most, true);
			if (field->most < INT32_MAX)
				try_command_value(session, command, field, base, c, beyond(field, field->most, 1),
				                  false);
			try_command_value(session, command, field, base, c, beyond(field, field->least, -1),
			                  false);
		}
	}
}

static void try_command(cau_session *session, cau_command *command)
{
	cau_part parts[CAU_MAX_PARTS];
	int count = cau_command_parts(command, parts);
	for (int i = 0; i < count; i++)
		try_command_part(session, command, parts[i].record, parts[i].base, parts[i].kind);
	cau_selection *selection = cau_command_selection(command);
	for (int kind = 0; selection && kind < CAU_SELECT_COUNT; kind++) {
		cau_default_selection(selection, kind);
		try_command_part(session, command, &cau_selection_record, selection, kind);
	}
}

static void every_row_of_a_command(void **state)
{
	(void)state;
	tried = 0;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	static cau_command command;
	for (int kind = 0; kind < CAU_COMMAND_COUNT; kind++) {
		cau_default_command(&command, kind);
		strcpy(command.tool, "hook");
		if (kind == CAU_COMMAND_TOOL_ADD)
			strcpy(command.as.definition.name, "another");
		for (int layer = 0; layer < (kind == CAU_COMMAND_SET_MATERIAL ? CAU_LAYER_COUNT : 1);
		     layer++) {
			if (kind == CAU_COMMAND_SET_MATERIAL) {
				command.as.material.kind = layer;
				strcpy(command.as.material.layer, "fat");
				cau_default_sheet_material(&command.as.material.sheet, CAU_LAYER_FASCIA);
				cau_default_fat_material(&command.as.material.fat);
				cau_default_link_material(&command.as.material.link);
			}
			try_command(session, &command);
		}
	}
	assert_true(tried > 500);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_row_of_a_scene),
		cmocka_unit_test(every_row_of_a_command),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
