// SPDX-License-Identifier: Apache-2.0
// The members that a scene may have. Scalars come from the tables of scene.h; vectors, names and
// choices are listed here.
#include "cautery/assert.h"
#include "json/document.h"
#include "json/record.h"

CHOICES(solver_choices, CAU_SOLVER_TABLE)
CHOICES(precision_choices, CAU_PRECISION_TABLE)
CHOICES(integrator_choices, CAU_INTEGRATOR_TABLE)
CHOICES(parting_choices, CAU_PARTING_TABLE)
CHOICES(energy_choices, CAU_ENERGY_TABLE)
CHOICES(mesh_source_choices, CAU_MESH_SOURCE_TABLE)
CHOICES_OF_WORDS(model_choices, CAU_MODEL_TABLE)
CHOICES(limit_choices, CAU_LIMIT_TABLE)
CHOICES(projection_choices, CAU_PROJECTION_TABLE)
CHOICES(layer_kind_choices, CAU_LAYER_TABLE)
CHOICES(living_choices, CAU_LIVING_TABLE)
CHOICES(select_kind_choices, CAU_SELECT_TABLE)
CHOICES_OF_WORDS(tool_shape_choices, CAU_TOOL_SHAPE_TABLE)

// clang-format off: tables
#define STRUCT cau_scene_def
static const cau_field scene_fields[] = {
	{OTHER(name, NAME, "name of the scene"), .required = true},
	{OTHER(description, TEXT, "description of the scene in words")},
	CAU_TIME_TABLE(SCALAR){INTEGER(
		iterations, 1, CAU_ITERATIONS_MOST,
		"largest number of iterations of a step (small tissue: up to 64); with `accuracy` 0, each "
		"step takes all")},
	{CHOICE(solver, solver_choices,
            "how the global step is solved; `newton` also uses Newton's method for all sheets")},
	{CHOICE(precision, precision_choices, "number format of the local and global steps")},
	{CHOICE(
		integrator, integrator_choices,
		"how a tick advances motion: `euler` damps, more for longer steps; `sdirk2` is of second "
		"order and solves twice a tick; at 60 steps/s it keeps 0.997 of a 5 Hz swing each period")},
	{CHOICE(parting, parting_choices,
            "what heat parts: `edges`, each with all elements that share it, as in the paper; or "
            "`elements` one by one, so that a cut does not depend on the mesh")},
	{CHOICE(
		energy, energy_choices,
		"model of an energized tool: with `paper` the hot part has a set temperature; with "
		"`tissue` "
		"a generator heats tissue, boils its water and parts elements (needs parting `elements`)")},
	{OTHER(seed, COUNT, "seed of all random numbers")},
	{VECTOR(gravity_m_s2, 3, -CAU_GRAVITY_MOST_M_S2, CAU_GRAVITY_MOST_M_S2, "m/s^2", "gravity")},
};
#undef STRUCT
RECORD(cau_scene_record, "a scene", scene_fields, NULL)

#define KIND(code) (1u << CAU_MESH_##code)
#define STRUCT cau_mesh_def
static const cau_field mesh_fields[] = {
	{CHOICE(source, mesh_source_choices, "where the mesh comes from"), .required = true},
	{OTHER(name, NAME, "name of the mesh"), .required = true},
	{VECTOR(size_m, 3, 1e-6, 10.0, "m", "extent, centred in x and y, top at z = 0"),
     .least_count = 1, .kinds = KIND(SHEET) | KIND(SLAB) | KIND(PATTERN)},
	{INTEGER(cells, 1, 1000,
             "cells along each axis; of a pattern, triangles of the fan, 3 at least"),
     .count = 3, .least_count = 1, .kinds = KIND(SHEET) | KIND(SLAB) | KIND(PATTERN)},
	{SCALAR_OF(texture_turn_rad, -6.3, 6.3, "rad", "turns the UV axes against the mesh's axes"),
     .kinds = KIND(SHEET) | KIND(PATTERN)},
	{OTHER(file, TEXT, "path of a mesh file, relative to the scene file"), .required = true,
     .kinds = KIND(FILE) | KIND(BYTES)},
	{SCALAR_OF(unit_m, CAU_MESH_UNIT_LEAST_M, CAU_MESH_UNIT_MOST_M, "m",
               "metres in one unit of the file"),
     .kinds = KIND(FILE) | KIND(BYTES)},
	{INTEGER(strict, 0, 1, "1: refuse a mesh with errors instead of repairing it"),
     .kinds = KIND(FILE) | KIND(BYTES)},
	{VECTOR(translate_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m",
            "translation of the mesh, applied after unit_m")},
};
#undef STRUCT
#undef KIND
RECORD(cau_mesh_record, "a mesh", mesh_fields, &mesh_source_choices)

#define KIND(code) (1u << CAU_LAYER_##code)
#define STRUCT cau_layer_def
static const cau_field layer_fields[] = {
	{CHOICE(kind, layer_kind_choices, "kind of tissue"), .required = true},
	{OTHER(name, NAME, "name of the layer"), .required = true},
	{OTHER(mesh, NAME, "mesh whose triangles or tetrahedra the layer takes"),
     .kinds = KIND(FASCIA) | KIND(FAT) | KIND(MEMBRANE)},
	{OTHER(of, NAME, "membrane: the fat layer whose boundary it covers; links: the upper layer"),
     .kinds = KIND(MEMBRANE) | KIND(LINKS)},
	{OTHER(to, NAME, "lower layer of the links"), .kinds = KIND(LINKS)},
	{VECTOR(fibre, 3, -CAU_FIBRE_MOST, CAU_FIBRE_MOST, "1",
            "material direction of a mesh without UV coordinates; fat: first material axis"),
     .kinds = KIND(FASCIA) | KIND(FAT) | KIND(MEMBRANE)},
	{CHOICE(
		tissue, living_choices,
		"with energy `tissue`: the tissue whose thermal and electric properties the layer has")},
	{SCALAR_OF(
		perfusion, 0.0, CAU_PERFUSION_MOST, "1",
		"with energy `tissue`: blood flow, as a share of the flow in living tissue; 0: none")},
	{SCALAR_OF(coagulated_tear, CAU_COAGULATED_TEAR_LEAST, 1.0, "1",
               "share of `tear_energy_j_m2` that a tear takes where exposure is 0.5 or more")},
	{SCALAR_OF(viscosity_s, 0.0, CAU_VISCOSITY_MOST_S, "s",
               "retardation time, viscosity over stiffness; a swing at f Hz has the damping ratio "
               "pi f viscosity_s; not with solver `diagonal`"),
     .kinds = KIND(FASCIA) | KIND(FAT) | KIND(MEMBRANE)},
};
#undef STRUCT
#undef KIND
RECORD(cau_layer_record, "a layer", layer_fields, &layer_kind_choices)

static const cau_field region_fields[] = {
	{.name = "region",
     .type = CAU_FIELD_INTEGER,
     .least = 0.0,
     .most = INT32_MAX,
     .required = true,
     .unit = "1",
     .meaning = "number of a region in the mesh file"},
};
RECORD(cau_region_record, "a region", region_fields, NULL)

#define LIMIT_FIELDS(entries, entry_names, axes)                                                   \
	{CHOICE(limit, limit_choices, "strain limit")},                                                \
		{CHOICE(projection, projection_choices, "how a target is projected")},                     \
		{VECTOR(target, entries, -CAU_TARGET_MOST, CAU_TARGET_MOST, "1",                           \
	            "target: " entry_names " of F^T F; positive definite")},                           \
		{VECTOR(strain_min, axes, CAU_STRAIN_LEAST, 0.0, "1",                                      \
	            "range: least engineering strain along each axis")},                               \
		{VECTOR(strain_max, axes, 0.0, CAU_STRAIN_MOST, "1",                                       \
	            "range: largest engineering strain along each axis")},                             \
		{VECTOR(                                                                                   \
			shrink, axes, CAU_SHRINK_LEAST, CAU_SHRINK_MOST, "1",                                  \
			"squared stretches to which the rims of cuts shrink (S of eq. 21); 1: no shrinkage")},

#define STRUCT cau_sheet_material
static const cau_field sheet_fields[] = {CAU_SHEET_TABLE(SCALAR)
                                             LIMIT_FIELDS(3, "t_00, t_11, t_01", 2)};
#undef STRUCT
RECORD(cau_sheet_record, "a sheet", sheet_fields, NULL)

#define STRUCT cau_fat_material
static const cau_field fat_fields[] = {
	{CHOICE(model, model_choices, "elastic law")},
	CAU_FAT_TABLE(SCALAR) LIMIT_FIELDS(6, "t_00, t_11, t_22, t_01, t_02, t_12", 3)};
#undef STRUCT
RECORD(cau_fat_record, "fat", fat_fields, NULL)

#define STRUCT cau_link_material
static const cau_field link_fields[] = {CAU_LINK_TABLE(SCALAR)};
#undef STRUCT
RECORD(cau_link_record, "links", link_fields, NULL)

#define STRUCT cau_heat_material
static const cau_field heat_fields[] = {CAU_HEAT_TABLE(SCALAR)};
#undef STRUCT
RECORD(cau_heat_record, "a heated material", heat_fields, NULL)

#define KIND(code) (1u << CAU_SELECT_##code)
#define STRUCT cau_selection
static const cau_field selection_fields[] = {
	{CHOICE(kind, select_kind_choices, "which vertices"), .required = true},
	{OTHER(layer, NAME, "only vertices of this layer; without it, of any layer")},
	{VECTOR(least_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m", "least corner of the box"),
     .required = true, .kinds = KIND(BOX)},
	{VECTOR(most_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m", "largest corner of the box"),
     .required = true, .kinds = KIND(BOX)},
	{VECTOR(center_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m",
            "centre of the sphere, or the point for `nearest`"),
     .required = true, .kinds = KIND(SPHERE) | KIND(NEAREST)},
	{SCALAR_OF(radius_m, 0.0, CAU_PLACE_MOST_M, "m", "radius of the sphere"), .required = true,
     .kinds = KIND(SPHERE)},
};
#undef STRUCT
#undef KIND
RECORD(cau_selection_record, "a selection", selection_fields, &select_kind_choices)

#define STRUCT cau_tool_def
static const cau_field tool_name_fields[] = {
	{OTHER(name, NAME, "name of the tool"), .required = true},
};
RECORD(cau_tool_name_record, "a tool", tool_name_fields, NULL)

static const cau_field tool_fields[] = {
	{CHOICE(shape, tool_shape_choices, "shape"), .required = true, .unless = "instrument"},
	CAU_TOOL_TABLE(SCALAR)};
#undef STRUCT
RECORD(cau_tool_record, "a tool", tool_fields, NULL)

#define STRUCT cau_pose
static const cau_field pose_fields[] = {
	{VECTOR(position_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m",
            "position of the tip at the start")},
	{OTHER(rotation, ROTATION, "unit quaternion w, x, y, z: tool frame (shaft along +z) to world")},
};
#undef STRUCT
RECORD(cau_pose_record, "a pose", pose_fields, NULL)

#define STRUCT cau_vessel_def
static const cau_field vessel_fields[] = {
	{OTHER(name, NAME, "name of the vessel"), .required = true},
	{OTHER(layer, NAME, "layer of fat in which the vessel lies"), .required = true},
	CAU_VESSEL_TABLE(SCALAR)};
#undef STRUCT
RECORD(cau_vessel_record, "a vessel", vessel_fields, NULL)

typedef struct vessel_point {
	double at_m[3];
} vessel_point;
#define STRUCT vessel_point
static const cau_field vessel_point_fields[] = {
	{VECTOR(at_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m", "position of the point at rest"),
     .required = true},
};
#undef STRUCT
RECORD(cau_vessel_point_record, "a point of a vessel", vessel_point_fields, NULL)

#define STRUCT cau_pull_def
static const cau_field pull_fields[] = {
	{VECTOR(move_m, 3, -CAU_PULL_MOST_M, CAU_PULL_MOST_M, "m",
            "displacement of the chosen vertices")},
	{SCALAR_OF(duration_s, CAU_PULL_LEAST_S, CAU_PULL_MOST_S, "s",
               "time that the displacement takes")},
};
#undef STRUCT
RECORD(cau_pull_record, "a pull", pull_fields, NULL)

#define STRUCT cau_cut_def
static const cau_field cut_fields[] = {
	{OTHER(tool, NAME, "name of the tool in the scene"), .required = true},
	{VECTOR(from_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m",
            "where the tip waits before the cut"),
     .required = true},
	{VECTOR(to_m, 3, -CAU_PLACE_MOST_M, CAU_PLACE_MOST_M, "m", "where the tip moves to"),
     .required = true},
	{OTHER(rotation, ROTATION, "unit quaternion w, x, y, z of the tool")},
	{SCALAR_OF(dwell_s, 0.0, CAU_DWELL_MOST_S, "s", "time that the tip waits at from_m")},
	{SCALAR_OF(speed_m_s, CAU_CUT_LEAST_M_S, CAU_CUT_MOST_M_S, "m/s",
               "speed of the tip on the cut")},
};
#undef STRUCT
RECORD(cau_cut_record, "a cut", cut_fields, NULL)

// clang-format on

int cau_material_parts(int layer_kind, cau_sheet_material *sheet, cau_fat_material *fat,
                       cau_link_material *link, cau_part parts[2])
{
	CAU_ASSERT_INDEX(layer_kind, CAU_LAYER_COUNT);
	if (layer_kind == CAU_LAYER_FAT) {
		parts[0] = (cau_part){&cau_fat_record, fat, 0};
		parts[1] = (cau_part){&cau_heat_record, &fat->heat, 0};
	} else if (layer_kind == CAU_LAYER_LINKS) {
		parts[0] = (cau_part){&cau_link_record, link, 0};
		parts[1] = (cau_part){&cau_heat_record, &link->heat, 0};
	} else {
		parts[0] = (cau_part){&cau_sheet_record, sheet, 0};
		parts[1] = (cau_part){&cau_heat_record, &sheet->heat, 0};
	}
	return 2;
}
