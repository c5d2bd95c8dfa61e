// SPDX-License-Identifier: GPL-3.0-or-later
// Range checks of all input, from the tables of scene.h. The paths in errors are JSON paths.
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "cautery/name.h"
#include "constraint/elements.h"
#include "session/session_internal.h"

enum { PATH_BYTES = 160 };

static void join(char out[PATH_BYTES], const char *path, const char *field)
{
	CAU_ASSERT(field[0] != 0, "a field without a name in \"%s\"", path);
	snprintf(out, PATH_BYTES, "%.80s%s%.70s", path, *path ? "." : "", field);
}

static cau_status in_range(double value, double least, double most, const char *unit,
                           const char *path, const char *field, cau_error *error)
{
	CAU_ASSERT(least <= most, "%s from %g to %g", field, least, most);
	if (value >= least && value <= most)
		return CAU_OK;
	char full[PATH_BYTES];
	join(full, path, field);
	return cau_fail(error, CAU_BAD_VALUE, full, "%g is not between %g and %g %s", value, least,
	                most, unit);
}

static cau_status is_choice(int value, int count, const char *path, const char *field,
                            cau_error *error)
{
	CAU_ASSERT(count > 0, "%s has %d choices", field, count);
	if (value >= 0 && value < count)
		return CAU_OK;
	char full[PATH_BYTES];
	join(full, path, field);
	return cau_fail(error, CAU_BAD_VALUE, full, "%d is not one of the choices 0 to %d", value,
	                count - 1);
}

static cau_status finite_vector(const double *v, int count, double most, const char *path,
                                const char *field, cau_error *error)
{
	CAU_ASSERT(count > 0 && most > 0, "%s has %d components within %g", field, count, most);
	for (int i = 0; i < count; i++)
		if (!(fabs(v[i]) <= most)) {
			char full[PATH_BYTES];
			join(full, path, field);
			return cau_fail(error, CAU_BAD_VALUE, full, "component %d, %g, is not within %g", i,
			                v[i], most);
		}
	return CAU_OK;
}

// Returns the refusal of another module, with `path` before the path that the refusal names.
static cau_status refuse_within(const cau_error *inner, const char *path, cau_error *error)
{
	CAU_ASSERT(inner->status != CAU_OK, "\"%s\" was not refused", path);
	char full[PATH_BYTES];
	join(full, path, inner->path);
	return cau_fail(error, inner->status, full, "%s", inner->reason);
}

#define CHECK_FIELD(field, default_, least, most, unit, meaning)                                   \
	if (!status)                                                                                   \
		status = in_range(object->field, least, most, unit, path, #field, error);

static cau_status check_name(const char *name, const char *path, const char *field,
                             cau_error *error)
{
	if (cau_name_is_valid(name))
		return CAU_OK;
	char full[PATH_BYTES];
	join(full, path, field);
	return cau_fail(error, CAU_BAD_VALUE, full, "\"%.60s\" is not a name: " CAU_NAME_RULE, name);
}

// ---- materials
static cau_status check_heat(const cau_heat_material *object, const char *path, cau_error *error)
{
	cau_status status = CAU_OK;
	CAU_HEAT_TABLE(CHECK_FIELD)
	return status;
}

static cau_status check_interval(const double *least, const double *most, int count,
                                 const char *path, cau_error *error)
{
	CAU_ASSERT(count == 2 || count == 3, "strains along %d axes", count);
	for (int i = 0; i < count; i++)
		if (!(least[i] >= CAU_STRAIN_LEAST && least[i] <= most[i] && most[i] <= CAU_STRAIN_MOST)) {
			char full[PATH_BYTES];
			join(full, path, "strain_min");
			return cau_fail(error, CAU_BAD_VALUE, full,
			                "axis %d: [%g, %g] is not an interval of strains within %g to %g", i,
			                least[i], most[i], CAU_STRAIN_LEAST, CAU_STRAIN_MOST);
		}
	return CAU_OK;
}

static cau_status check_shrink(const double *shrink, int count, const char *path, cau_error *error)
{
	CAU_ASSERT(count == 2 || count == 3, "shrinkage along %d axes", count);
	for (int i = 0; i < count; i++)
		if (!(shrink[i] >= CAU_SHRINK_LEAST && shrink[i] <= CAU_SHRINK_MOST)) {
			char full[PATH_BYTES];
			join(full, path, "shrink");
			return cau_fail(error, CAU_BAD_VALUE, full,
			                "component %d, %g, is not between %g and %g (squared stretch)", i,
			                shrink[i], CAU_SHRINK_LEAST, CAU_SHRINK_MOST);
		}
	return CAU_OK;
}

// Checks a target T, which must be symmetric positive definite. The eigenvalues are squared
// stretches, from 1e-4 to 100.
static cau_status check_target(const double eigen[3], int count, const char *path, cau_error *error)
{
	for (int i = 0; i < count; i++)
		if (!(eigen[i] >= 1e-4 && eigen[i] <= 100)) {
			char full[PATH_BYTES];
			join(full, path, "target");
			return cau_fail(error, CAU_BAD_VALUE, full,
			                "the target must be positive definite, with squared stretches from "
			                "1e-4 to 100; one "
			                "squared stretch is %g",
			                eigen[i]);
		}
	return CAU_OK;
}

static cau_status check_sheet(const cau_sheet_material *object, const char *path, cau_error *error)
{
	cau_status status = CAU_OK;
	CAU_SHEET_TABLE(CHECK_FIELD)
	if (!status)
		status = is_choice(object->limit, CAU_LIMIT_COUNT, path, "limit", error);
	if (!status)
		status = is_choice(object->projection, CAU_PROJECTION_COUNT, path, "projection", error);
	if (!status)
		status = check_interval(object->strain_min, object->strain_max, 2, path, error);
	const double *t = object->target;
	double mean = (t[0] + t[1]) / 2, spread = hypot((t[0] - t[1]) / 2, t[2]);
	const double eigen[3] = {mean + spread, mean - spread, 1};
	if (!status)
		status = check_target(eigen, 2, path, error);
	if (!status)
		status = check_shrink(object->shrink, 2, path, error);
	return status ? status : check_heat(&object->heat, path, error);
}

static cau_status check_fat(const cau_fat_material *object, const char *path, cau_error *error)
{
	cau_status status = CAU_OK;
	CAU_FAT_TABLE(CHECK_FIELD)
	if (!status)
		status = is_choice(object->model, CAU_MODEL_COUNT, path, "model", error);
	if (!status && object->poisson_ratio > cau_law_of(object->model)->poisson_most) {
		const cau_law *law = cau_law_of(object->model);
		char full[PATH_BYTES];
		join(full, path, "poisson_ratio");
		status = cau_fail(error, CAU_BAD_VALUE, full, "%g: model \"%s\" is stable up to %.3g only",
		                  object->poisson_ratio, law->word, law->poisson_most);
	}
	if (!status)
		status = is_choice(object->limit, CAU_LIMIT_COUNT, path, "limit", error);
	if (!status)
		status = is_choice(object->projection, CAU_PROJECTION_COUNT, path, "projection", error);
	if (!status)
		status = check_interval(object->strain_min, object->strain_max, 3, path, error);
	double eigen[3], axes[3][3];
	if (!status)
		status = finite_vector(object->target, 6, CAU_TARGET_MOST, path, "target", error);
	if (!status) {
		cau_symmetric_eigen3(object->target, eigen, axes);
		status = check_target(eigen, 3, path, error);
	}
	if (!status)
		status = check_shrink(object->shrink, 3, path, error);
	return status ? status : check_heat(&object->heat, path, error);
}

static cau_status check_link(const cau_link_material *object, const char *path, cau_error *error)
{
	cau_status status = CAU_OK;
	CAU_LINK_TABLE(CHECK_FIELD)
	return status ? status : check_heat(&object->heat, path, error);
}

cau_status cau_material_check(int kind, const void *material, const char *path, cau_error *error)
{
	switch (kind) {
	case CAU_LAYER_FAT:
		return check_fat(material, path, error);
	case CAU_LAYER_LINKS:
		return check_link(material, path, error);
	case CAU_LAYER_FASCIA:
	case CAU_LAYER_MEMBRANE:
		return check_sheet(material, path, error);
	default:
		return is_choice(kind, CAU_LAYER_COUNT, path, "kind", error);
	}
}

// ---- tools, selections, poses
cau_status cau_pose_check(const cau_pose *pose, const char *path, cau_error *error)
{
	cau_status status =
		finite_vector(pose->position_m, 3, CAU_PLACE_MOST_M, path, "position_m", error);
	if (!status)
		status = finite_vector(pose->rotation, 4, 1.001, path, "rotation", error);
	double squared = 0;
	for (int i = 0; i < 4; i++)
		squared += pose->rotation[i] * pose->rotation[i];
	if (!status && !(fabs(sqrt(squared) - 1) <= 1e-3)) {
		char full[PATH_BYTES];
		join(full, path, "rotation");
		status = cau_fail(error, CAU_BAD_VALUE, full,
		                  "a unit quaternion is needed; its length is %g", sqrt(squared));
	}
	return status;
}

// Least heat capacity of a blade, J/K: that of 2.5 mm^3 of steel. With a lighter blade the heat
// step would need more than two substeps: closed jaws of 20 x 4 mm touch cells of 0.25 mm with 0.6
// W/K.
static const double least_blade_j_k = 0.01;

static cau_status check_blade(const cau_tool_def *tool, const char *path, cau_error *error)
{
	char full[PATH_BYTES];
	double heat = tool->blade_heat_j_k;
	join(full, path, "blade_heat_j_k");
	if (heat > 0 && heat < least_blade_j_k)
		return cau_fail(error, CAU_BAD_VALUE, full, "%g is neither 0 nor at least %g J/K", heat,
		                least_blade_j_k);
	join(full, path, "load_rise_off");
	if (tool->load_rise_off > 0 && tool->load_rise_off <= 1)
		return cau_fail(error, CAU_BAD_VALUE, full, "%g is neither 0 nor more than 1",
		                tool->load_rise_off);
	return CAU_OK;
}

cau_status cau_tool_check(const cau_tool_def *object, const char *path, double step_s,
                          cau_error *error)
{
	CAU_ASSERT(step_s > 0, "a tool for steps of %g s", step_s);
	cau_status status = check_name(object->name, path, "name", error);
	if (!status)
		status = is_choice(object->shape, CAU_TOOL_SHAPE_COUNT, path, "shape", error);
	CAU_TOOL_TABLE(CHECK_FIELD)
	if (!status)
		status = check_blade(object, path, error);
	if (!status)
		status = cau_pose_check(&object->pose, path, error);
	if (status)
		return status;
	cau_error inner = {0}; // the heat grid checks its own stability limits
	status = cau_heat_grid_check(object, step_s, &inner);
	return status ? refuse_within(&inner, path, error) : CAU_OK;
}

cau_status cau_selection_check(const cau_selection *selection, const char *path, cau_error *error)
{
	cau_status status = is_choice(selection->kind, CAU_SELECT_COUNT, path, "select", error);
	if (!status && selection->layer[0])
		status = check_name(selection->layer, path, "layer", error);
	if (!status)
		status = finite_vector(selection->least_m, 3, CAU_PLACE_MOST_M, path, "least_m", error);
	if (!status)
		status = finite_vector(selection->most_m, 3, CAU_PLACE_MOST_M, path, "most_m", error);
	if (!status)
		status = finite_vector(selection->center_m, 3, CAU_PLACE_MOST_M, path, "center_m", error);
	if (!status)
		status = in_range(selection->radius_m, 0, CAU_PLACE_MOST_M, "m", path, "radius_m", error);
	return status;
}

// ---- scene
static int32_t find_layer(const cau_scene_def *scene, const char *name)
{
	for (int32_t i = 0; i < scene->layer_count; i++)
		if (!strcmp(scene->layers[i].name, name))
			return i;
	return -1;
}

static int32_t find_mesh(const cau_scene_def *scene, const char *name)
{
	for (int32_t i = 0; i < scene->mesh_count; i++)
		if (!strcmp(scene->meshes[i].name, name))
			return i;
	return -1;
}

static cau_status missing(const char *path, const char *field, const char *what, const char *name,
                          cau_error *error)
{
	char full[PATH_BYTES];
	join(full, path, field);
	return cau_fail(error, CAU_NOT_FOUND, full, "there is no %s \"%.60s\"", what, name);
}

static cau_status check_layer_links(const cau_scene_def *scene, const cau_layer_def *layer,
                                    const char *path, cau_error *error)
{
	int32_t of = find_layer(scene, layer->of), to = find_layer(scene, layer->to);
	if (layer->kind == CAU_LAYER_LINKS) {
		if (of < 0 || scene->layers[of].kind == CAU_LAYER_LINKS)
			return missing(path, "of", "sheet or fat layer", layer->of, error);
		if (to < 0 || to == of || scene->layers[to].kind == CAU_LAYER_LINKS)
			return missing(path, "to", "other sheet or fat layer", layer->to, error);
		return CAU_OK;
	}
	if (layer->kind == CAU_LAYER_MEMBRANE && layer->of[0]) {
		if (of < 0 || scene->layers[of].kind != CAU_LAYER_FAT)
			return missing(path, "of", "fat layer", layer->of, error);
		return CAU_OK;
	}
	return find_mesh(scene, layer->mesh) < 0 ? missing(path, "mesh", "mesh", layer->mesh, error)
	                                         : CAU_OK;
}

const void *cau_layer_material(const cau_layer_def *layer, int32_t index)
{
	CAU_ASSERT_INDEX(index, CAU_MAX_MATERIALS);
	if (layer->kind == CAU_LAYER_FAT)
		return &layer->fat[index];
	return layer->kind == CAU_LAYER_LINKS ? (const void *)&layer->link : &layer->sheet[index];
}

static cau_status check_layer(const cau_scene_def *scene, int32_t index, cau_error *error)
{
	const cau_layer_def *layer = &scene->layers[index];
	char path[PATH_BYTES];
	snprintf(path, sizeof path, "layers[%d]", index);
	cau_status status = check_name(layer->name, path, "name", error);
	if (!status && find_layer(scene, layer->name) != index)
		status =
			cau_fail(error, CAU_ALREADY_EXISTS, path, "two layers are named \"%s\"", layer->name);
	if (!status)
		status = is_choice(layer->kind, CAU_LAYER_COUNT, path, "kind", error);
	if (!status)
		status = is_choice(layer->tissue, CAU_LIVING_COUNT, path, "tissue", error);
	if (!status)
		status = in_range(layer->perfusion, 0.0, CAU_PERFUSION_MOST, "1", path, "perfusion", error);
	if (!status)
		status = in_range(layer->coagulated_tear, CAU_COAGULATED_TEAR_LEAST, 1.0, "1", path,
		                  "coagulated_tear", error);
	if (!status)
		status = in_range(layer->viscosity_s, 0.0, CAU_VISCOSITY_MOST_S, "s", path, "viscosity_s",
		                  error);
	if (!status && layer->viscosity_s > 0 && layer->kind == CAU_LAYER_LINKS)
		status = cau_fail(error, CAU_BAD_VALUE, path, "viscosity_s: links have no viscosity");
	if (!status && layer->viscosity_s > 0 && scene->solver == CAU_SOLVER_DIAGONAL)
		status = cau_fail(error, CAU_BAD_VALUE, path,
		                  "viscosity_s: the solver \"diagonal\" has no viscosity");
	if (!status)
		status = finite_vector(layer->fibre, 3, CAU_FIBRE_MOST, path, "fibre", error);
	if (!status && !(layer->material_count >= 1 && layer->material_count <= CAU_MAX_MATERIALS))
		status =
			cau_fail(error, CAU_BAD_VALUE, path, "the layer has %d materials; 1 to %d are allowed",
		             layer->material_count, CAU_MAX_MATERIALS);
	for (int32_t m = 0; m < layer->material_count && !status; m++) {
		char inner[PATH_BYTES];
		if (m)
			snprintf(inner, sizeof inner, "layers[%d].regions[%d]", index, m - 1);
		else
			snprintf(inner, sizeof inner, "layers[%d]", index);
		status = cau_material_check(layer->kind, cau_layer_material(layer, m), inner, error);
	}
	return status ? status : check_layer_links(scene, layer, path, error);
}

static cau_status check_mesh(const cau_scene_def *scene, int32_t index, cau_error *error)
{
	const cau_mesh_def *mesh = &scene->meshes[index];
	char path[PATH_BYTES];
	snprintf(path, sizeof path, "meshes[%d]", index);
	cau_status status = check_name(mesh->name, path, "name", error);
	if (!status && find_mesh(scene, mesh->name) != index)
		status =
			cau_fail(error, CAU_ALREADY_EXISTS, path, "two meshes are named \"%s\"", mesh->name);
	if (!status)
		status = is_choice(mesh->source, CAU_MESH_SOURCE_COUNT, path, "source", error);
	if (!status)
		status = finite_vector(mesh->translate_m, 3, CAU_PLACE_MOST_M, path, "translate_m", error);
	if (!status)
		status = in_range(mesh->unit_m, CAU_MESH_UNIT_LEAST_M, CAU_MESH_UNIT_MOST_M, "m", path,
		                  "unit_m", error);
	cau_error inner = {0};
	if (!status && cau_mesh_check_cells(mesh->source, mesh->cells, &inner))
		status = refuse_within(&inner, path, error);
	return status;
}

static cau_status check_vessel(const cau_scene_def *scene, int32_t index, cau_error *error)
{
	const cau_vessel_def *object = &scene->vessels[index];
	char path[PATH_BYTES];
	snprintf(path, sizeof path, "vessels[%d]", index);
	cau_status status = check_name(object->name, path, "name", error);
	for (int32_t i = 0; i < index && !status; i++)
		if (!strcmp(scene->vessels[i].name, object->name))
			status = cau_fail(error, CAU_ALREADY_EXISTS, path, "two vessels are named \"%s\"",
			                  object->name);
	CAU_VESSEL_TABLE(CHECK_FIELD)
	if (!status && !(object->wall_m < object->radius_m))
		status = cau_fail(error, CAU_BAD_VALUE, path,
		                  "a wall of %g m leaves no lumen in a tube of radius %g m", object->wall_m,
		                  object->radius_m);
	if (!status && !(object->point_count >= 2 && object->point_count <= CAU_MAX_VESSEL_POINTS))
		status =
			cau_fail(error, CAU_BAD_VALUE, path, "the vessel has %d points; 2 to %d are allowed",
		             object->point_count, CAU_MAX_VESSEL_POINTS);
	bool has_length = false;
	for (int32_t i = 0; i < object->point_count && !status; i++) {
		status = finite_vector(object->points_m[i], 3, CAU_PLACE_MOST_M, path, "points", error);
		for (int c = 0; c < 3; c++)
			has_length |= object->points_m[i][c] != object->points_m[0][c];
	}
	if (!status && !has_length)
		status = cau_fail(error, CAU_BAD_VALUE, path,
		                  "all points of the vessel are at the same position");
	int32_t layer = find_layer(scene, object->layer);
	if (!status && (layer < 0 || scene->layers[layer].kind != CAU_LAYER_FAT))
		status = missing(path, "layer", "layer of fat", object->layer, error);
	if (!status && scene->energy != CAU_ENERGY_TISSUE)
		status = cau_fail(error, CAU_BAD_VALUE, path, "vessels need energy \"tissue\"");
	return status;
}

static cau_status check_counts(const cau_scene_def *scene, cau_error *error)
{
	const struct {
		const char *what;
		int32_t count, least, most;
	} counts[] = {
		{"meshes", scene->mesh_count, 1, CAU_MAX_MESHES},
		{"layers", scene->layer_count, 1, CAU_MAX_LAYERS},
		{"pins", scene->pin_count, 0, CAU_MAX_PINS},
		{"tools", scene->tool_count, 0, CAU_MAX_TOOLS},
		{"vessels", scene->vessel_count, 0, CAU_MAX_VESSELS},
	};
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		if (counts[i].count < counts[i].least || counts[i].count > counts[i].most)
			return cau_fail(error, CAU_BAD_VALUE, counts[i].what,
			                "there are %d; %d to %d are allowed", counts[i].count, counts[i].least,
			                counts[i].most);
	return CAU_OK;
}

static cau_status check_time(const cau_scene_def *object, cau_error *error)
{
	const char *path = "";
	cau_status status = CAU_OK;
	CAU_TIME_TABLE(CHECK_FIELD)
	if (!status && !(object->iterations >= 1 && object->iterations <= CAU_ITERATIONS_MOST))
		status = cau_fail(error, CAU_BAD_VALUE, "iterations", "%d is not between 1 and %d",
		                  object->iterations, CAU_ITERATIONS_MOST);
	if (!status)
		status = is_choice(object->solver, CAU_SOLVER_COUNT, path, "solver", error);
	if (!status)
		status = is_choice(object->precision, CAU_PRECISION_COUNT, path, "precision", error);
	if (!status)
		status = finite_vector(object->gravity_m_s2, 3, CAU_GRAVITY_MOST_M_S2, path, "gravity_m_s2",
		                       error);
	return status;
}

static cau_status check_scripts(const cau_scene_def *scene, cau_error *error)
{
	cau_status status = CAU_OK;
	if (scene->pull.present) {
		status = cau_selection_check(&scene->pull.selection, "pull.selection", error);
		if (!status)
			status = finite_vector(scene->pull.move_m, 3, CAU_PULL_MOST_M, "pull", "move_m", error);
		if (!status)
			status = in_range(scene->pull.duration_s, CAU_PULL_LEAST_S, CAU_PULL_MOST_S, "s",
			                  "pull", "duration_s", error);
	}
	if (!status && scene->cut.present) {
		status = finite_vector(scene->cut.from_m, 3, CAU_PLACE_MOST_M, "cut", "from_m", error);
		if (!status)
			status = finite_vector(scene->cut.to_m, 3, CAU_PLACE_MOST_M, "cut", "to_m", error);
		if (!status)
			status = in_range(scene->cut.speed_m_s, CAU_CUT_LEAST_M_S, CAU_CUT_MOST_M_S, "m/s",
			                  "cut", "speed_m_s", error);
	}
	return status;
}

cau_status cau_scene_check(const cau_scene_def *scene, cau_error *error)
{
	cau_status status = check_name(scene->name, "", "name", error);
	if (!status)
		status = check_time(scene, error);
	if (!status)
		status = check_counts(scene, error);
	for (int32_t i = 0; i < scene->mesh_count && !status; i++)
		status = check_mesh(scene, i, error);
	for (int32_t i = 0; i < scene->layer_count && !status; i++)
		status = check_layer(scene, i, error);
	char path[PATH_BYTES];
	for (int32_t i = 0; i < scene->pin_count && !status; i++) {
		snprintf(path, sizeof path, "pins[%d]", i);
		status = cau_selection_check(&scene->pins[i], path, error);
	}
	for (int32_t i = 0; i < scene->tool_count && !status; i++) {
		snprintf(path, sizeof path, "tools[%d]", i);
		status = cau_tool_check(&scene->tools[i], path, scene->step_s, error);
	}
	for (int32_t i = 0; i < scene->vessel_count && !status; i++)
		status = check_vessel(scene, i, error);
	if (!status && scene->energy == CAU_ENERGY_TISSUE && scene->parting != CAU_PARTING_ELEMENTS)
		status = cau_fail(error, CAU_BAD_VALUE, "parting",
		                  "energy \"tissue\" parts elements: set parting to \"elements\"");
	return status ? status : check_scripts(scene, error);
}
