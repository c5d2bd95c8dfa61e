// SPDX-License-Identifier: Apache-2.0
// A scene: the plain data from which a session is made. Core checks and builds a scene; protocol
// reads and writes it as JSON. Units are SI; temperatures are in degrees Celsius.
//
// Every scalar parameter is defined once, in a table X(field, default, least, most, unit, meaning).
// The tables make the struct fields, the defaults, the range checks, the JSON fields (JSON name =
// field name) and the documentation. Lengths, vectors and choices are defined outside the tables.
//
//     #include "cautery/defaults.h"
//     #include "cautery/scene.h"
//
//     // A taut sheet, pinned at its rim. The struct is large: keep it on the heap.
//     static void make_drum(cau_scene_def *scene)
//     {
//         cau_default_scene_def(scene);
//         scene->mesh_count = scene->layer_count = scene->pin_count = 1;
//         cau_default_mesh_def(&scene->meshes[0]);
//         strcpy(scene->meshes[0].name, "sheet");
//         cau_default_layer_def(&scene->layers[0], CAU_LAYER_FASCIA);
//         strcpy(scene->layers[0].name, "fascia");
//         strcpy(scene->layers[0].mesh, "sheet");
//         scene->layers[0].sheet[0].target[0] = 0.1; // wants to be 32 % as long along its fibres
//         cau_default_selection(&scene->pins[0], CAU_SELECT_RIM);
//     }
#pragma once

#include <stddef.h>
#include <stdint.h>

enum {
	CAU_NAME_BYTES = 49,  // bytes of a name: [a-z][a-z0-9]*([_-][a-z0-9]+)*, at most 48, and a zero
	CAU_TEXT_BYTES = 256, // bytes of a description or a file name, with its zero
	CAU_MAX_MESHES = 8,   // most meshes of a scene
	CAU_MAX_LAYERS = 12,  // most layers of a scene
	CAU_MAX_MATERIALS = 16,     // most materials of one layer: the default and those of its regions
	CAU_MAX_PINS = 16,          // most selections of pinned vertices of a scene
	CAU_MAX_TOOLS = 8,          // most tools of a session
	CAU_MAX_VESSELS = 8,        // most vessels of a scene
	CAU_MAX_VESSEL_POINTS = 32, // most points of the line of one vessel
};

#define CAU_FIELD(field, default_, least, most, unit, meaning) double field;

// ---- ranges of vectors, scripts and forces ----------------------------------------------------
// The tables below have the ranges of scalars. The parameter tables of protocol/json document these
// ranges, and the core enforces them.
#define CAU_UNIT_TOLERANCE 1e-3 // largest error of the length of a unit quaternion, for every input
// largest absolute value of each coordinate of a position or a displacement
#define CAU_PLACE_MOST_M 100.0
#define CAU_GRAVITY_MOST_M_S2 100.0
// largest absolute value of each component of an outer force on one vertex
#define CAU_FORCE_MOST_N 1000.0
#define CAU_FIBRE_MOST 1e6
#define CAU_TARGET_MOST 100.0 // largest absolute value of each entry of a target
#define CAU_STRAIN_LEAST (-0.99)
#define CAU_STRAIN_MOST 100.0
#define CAU_SHRINK_LEAST 0.01 // least squared stretch by shrinkage
#define CAU_SHRINK_MOST 4.0
#define CAU_MESH_UNIT_LEAST_M 1e-9
#define CAU_MESH_UNIT_MOST_M 1000.0
#define CAU_ITERATIONS_MOST 1000
#define CAU_PERFUSION_MOST 10.0
#define CAU_COAGULATED_TEAR_LEAST 0.01
#define CAU_VISCOSITY_MOST_S 10.0
#define CAU_PULL_MOST_M 1.0
#define CAU_PULL_LEAST_S 1e-3
#define CAU_PULL_MOST_S 3600.0
#define CAU_DWELL_MOST_S 3600.0
#define CAU_CUT_LEAST_M_S 1e-5
#define CAU_CUT_MOST_M_S 1.0

// ---- time and solver ------------------------------------------------------------------------
#define CAU_TIME_TABLE(X)                                                                          \
	X(step_s, 1.0 / 60.0, 1.0 / 1000.0, 1.0 / 30.0, "s", "time step; one tick")                    \
	X(damping_per_s, 0.0, 0.0, 1000.0, "1/s",                                                      \
	  "damping rate c: each step multiplies velocities by exp(-c step_s)")                         \
	X(ambient_c, 37.0, -20.0, 60.0, "degC", "temperature of the body around the tools")            \
	X(tolerance, 0.0, 0.0, 1.0, "1", "relative residual at which a step ends; 0: not used")        \
	X(accuracy, 0.01, 0.0, 1.0, "1",                                                               \
	  "largest error of a step, relative to its motion; 0: all iterations")                        \
	X(contact_thickness_m, 0.0, 0.0, 0.01, "m",                                                    \
	  "least distance between tissue surfaces; 0: no tissue contact")                              \
	X(contact_friction, 0.1, 0.0, 2.0, "1", "Coulomb coefficient of tissue on tissue")             \
	X(cell_m, 2.5e-4, 1e-4, 5e-3, "m",                                                             \
	  "edge length of one cell of the heat computation; for energy tissue")

#define CAU_SOLVER_TABLE(X) /* code, JSON name */                                                  \
	X(CHOLESKY, "cholesky")                                                                        \
	X(DIAGONAL, "diagonal")                                                                        \
	X(NEWTON, "newton")
#define CAU_PRECISION_TABLE(X)                                                                     \
	X(SINGLE, "single")                                                                            \
	X(DOUBLE, "double")
#define CAU_INTEGRATOR_TABLE(X)                                                                    \
	X(EULER, "euler")   /* implicit Euler (eq. 1-4): one solve a tick; long steps damp more */     \
	X(SDIRK2, "sdirk2") /* second order (Alexander 1977): two solves a tick */
#define CAU_ENERGY_TABLE(X)                                                                        \
	X(PAPER, "paper")   /* a hot part has a temperature; exposure parts tissue (section 6.2) */    \
	X(TISSUE, "tissue") /* a generator gives power; tissue parts where its water has boiled off */
#define CAU_PARTING_TABLE(X)                                                                       \
	X(EDGES, "edges")       /* the paper's rule: an edge and all elements that share it */         \
	X(ELEMENTS, "elements") /* each triangle and tetrahedron, by the exposure at its middle */

// ---- meshes ---------------------------------------------------------------------------------
#define CAU_MESH_SOURCE_TABLE(X)                                                                   \
	X(SHEET, "sheet")     /* size_m[0..1], cells[0..1]: two triangles a cell, UV along x and y */  \
	X(SLAB, "slab")       /* size_m, cells: six tetrahedra a cell */                               \
	X(PATTERN, "pattern") /* figure 5: a small fan of cells[0] triangles round one vertex */       \
	X(FILE, "file")       /* a mesh file: core/mesh/README.md */                                   \
	X(BYTES, "bytes")     /* an uploaded file, in memory */

// One mesh of a scene, generated or read from a file.
typedef struct cau_mesh_def {
	char name[CAU_NAME_BYTES]; // name by which layers refer to the mesh
	int source;                // CAU_MESH_*
	double size_m[3]; // generated meshes: extents, centred on the origin in x and y, top at z = 0
	int32_t cells[3]; // generated meshes: number of cells along each axis
	double texture_turn_rad; // generated sheets: rotation of the UV axes against the mesh's axes
	// FILE: path relative to the scene file. BYTES: name, whose ending gives the format
	char file[CAU_TEXT_BYTES];
	double unit_m;         // length of one unit of the file, m (0.001 for millimetres)
	double translate_m[3]; // translation, applied after the unit
	int32_t strict;        // read meshes: 1: refuse a mesh that would have to be mended
	const void *bytes;     // BYTES: borrowed until the session is created
	size_t byte_count;     // size of `bytes`
} cau_mesh_def;

// ---- materials ------------------------------------------------------------------------------

// The laws of fat. The columns are: code; word in JSON; largest Poisson's ratio; whether the stress
// is the gradient of an energy; whether the law keeps a rotation between evaluations; a; b;
// description. The law is evaluated with the Lame parameters lambda + a mu and b mu. With a = 0 and
// b = 1 they are those of small strain. The function `word`_stress in core/constraint/fat_energy.h
// computes the stress of the law `word`.
#define CAU_MODEL_TABLE(X)                                                                         \
	X(NEOHOOKEAN, neohookean, 0.45, true, false, 5.0 / 6.0, 4.0 / 3.0,                             \
	  "stable neo-Hookean (Smith et al. 2018); inverted tetrahedra recover")                       \
	X(COROTATED, corotated, 0.45, true, true, 0.0, 1.0,                                            \
	  "linear elasticity in the frame of the nearest rotation")                                    \
	X(STVK, stvk, 0.45, true, false, 0.0, 1.0,                                                     \
	  "St. Venant-Kirchhoff; weak in compression, does not resist inversion")                      \
	X(ENERGY, energy, 1.0 / 3.0, false, false, 0.0, 1.0,                                           \
	  "the energy constraint as printed (eq. 14-17)")
#define CAU_LIMIT_TABLE(X)                                                                         \
	X(NONE, "none")                                                                                \
	X(TARGET, "target") /* F^T F is driven to T (eq. 11, 12) */                                    \
	X(RANGE, "range")   /* strains kept inside an interval */
#define CAU_PROJECTION_TABLE(X)                                                                    \
	X(CLOSED_FORM, "closed_form") /* P = Q T^(1/2) */                                              \
	X(LINEARISED, "linearised")   /* eq. 13 in F */

// Properties of all tissue: how heat parts it (section 6.2, 6.3), and the energy of a tear.
#define CAU_HEAT_TABLE(X)                                                                          \
	X(ignition_c, 172.0, 1.0, 2000.0, "degC",                                                      \
	  "tissue parts when exposure times absorption_per_s exceeds this")                            \
	X(ignition_spread_c, 0.0, 0.0, 500.0, "degC",                                                  \
	  "standard deviation of ignition_c in the tissue, drawn from the seed")                       \
	X(ignition_bundle_m, 0.0, 0.0, 0.1, "m",                                                       \
	  "width of fibre bundles that share one ignition temperature; 0: no bundles")                 \
	X(absorption_per_s, 0.4, 0.0, 1000.0, "1/s",                                                   \
	  "rate at which tissue takes up heat (xi of eq. 20)")                                         \
	X(tear_energy_j_m2, 0.0, 0.0, 1e6, "J/m^2",                                                    \
	  "energy of a tear per area; 0: tissue does not tear")

#define CAU_SHEET_TABLE(X)                                                                         \
	X(thickness_m, 5e-4, 1e-6, 0.05, "m", "sheet thickness")                                       \
	X(density_kg_m3, 1100.0, 1.0, 25000.0, "kg/m^3", "mass density")                               \
	X(limit_stiffness_pa, 1e6, 1.0, 1e10, "Pa", "stiffness k of the strain limit")                 \
	X(shear_max, 0.0, 0.0, 0.99, "1",                                                              \
	  "limit range: largest shear, the cosine of the angle between material axes")                 \
	X(bending_stiffness_nm, 0.0, 0.0, 10.0, "N m", "bending stiffness; 0: bending is not resisted")

#define CAU_FAT_TABLE(X)                                                                           \
	X(density_kg_m3, 911.0, 1.0, 25000.0, "kg/m^3", "mass density")                                \
	X(young_modulus_pa, 5000.0, 1.0, 1e10, "Pa", "Young's modulus")                                \
	X(poisson_ratio, 0.4, 0.0, 0.45, "1", "Poisson's ratio; at most 1/3 for model energy")         \
	X(limit_stiffness_pa, 1000.0, 1.0, 1e10, "Pa", "stiffness of the strain limit and shrinkage")  \
	X(shear_max, 0.0, 0.0, 0.99, "1",                                                              \
	  "limit range: largest shear, the cosine of the angle between material axes")                 \
	X(yield_strain, 0.0, 0.0, 10.0, "1",                                                           \
	  "deviatoric Green strain at which plastic flow begins (gamma_1)")                            \
	X(plastic_strain_max, 0.0, 0.0, 10.0, "1",                                                     \
	  "largest plastic strain (gamma_2); 0: no plastic flow")

#define CAU_LINK_TABLE(X)                                                                          \
	X(young_modulus_pa, 1e5, 1.0, 1e11, "Pa", "Young's modulus of a truss")                        \
	X(area_m2, 1e-6, 1e-12, 1.0, "m^2", "cross section of a truss")                                \
	X(reach_m, 5e-3, 1e-6, 1.0, "m", "length of the longest truss")                                \
	X(per_vertex, 3.0, 1.0, 8.0, "1", "number of trusses from each vertex of the upper sheet")

// How heat parts a tissue, and what tears it: the members of CAU_HEAT_TABLE.
typedef struct cau_heat_material {
	CAU_HEAT_TABLE(CAU_FIELD)
} cau_heat_material;

// The material of a fascia or a membrane, or of one region of it.
typedef struct cau_sheet_material {
	// region of the mesh file; ignored for the layer's first material, which is its default
	int32_t region;
	CAU_SHEET_TABLE(CAU_FIELD)
	int limit;        // CAU_LIMIT_*
	int projection;   // CAU_PROJECTION_*
	double target[3]; // TARGET: t_00, t_11, t_01: squared stretches; T positive definite
	// RANGE: lower ends of the engineering strains sqrt(k_aa) - 1 along u and v
	double strain_min[2];
	double strain_max[2];   // RANGE: upper ends of these strains
	double shrink[2];       // S_x, S_y of eq. 21: squared stretches
	cau_heat_material heat; // how heat parts the tissue
} cau_sheet_material;

// The material of fat, or of one region of it.
typedef struct cau_fat_material {
	// region of the mesh file; ignored for the layer's first material, which is its default
	int32_t region;
	CAU_FAT_TABLE(CAU_FIELD)
	int model;            // CAU_MODEL_*
	int limit;            // CAU_LIMIT_*
	int projection;       // CAU_PROJECTION_*
	double target[6];     // TARGET: t_00, t_11, t_22, t_01, t_02, t_12 in the material axes
	double strain_min[3]; // RANGE: lower ends of the strains sqrt(k_aa) - 1 along the material axes
	double strain_max[3]; // RANGE: upper ends of these strains
	double shrink[3];     // S_x, S_y, S_z of eq. 21: squared stretches
	cau_heat_material heat; // how heat parts the tissue
} cau_fat_material;

// The material of links: trusses between two layers.
typedef struct cau_link_material {
	CAU_LINK_TABLE(CAU_FIELD)
	cau_heat_material heat; // how heat parts the tissue
} cau_link_material;

// ---- layers ---------------------------------------------------------------------------------
#define CAU_LAYER_TABLE(X)                                                                         \
	X(FASCIA, "fascia")     /* a sheet over its own mesh's triangles */                            \
	X(MEMBRANE, "membrane") /* a sheet; with `of`, the boundary of that fat layer */               \
	X(FAT, "fat")           /* the tetrahedra of its mesh */                                       \
	X(LINKS, "links")       /* trusses from each vertex of layer `of` to the nearest of `to` */

// The living tissue of a layer, for heat and current with energy `tissue`.
// core/bioheat/bioheat.c has the values of each entry.
#define CAU_LIVING_TABLE(X)                                                                        \
	X(CONNECTIVE, "connective") /* fascia, membranes and strands: values of muscle */              \
	X(FAT, "fat")                                                                                  \
	X(LIVER, "liver")                                                                              \
	X(MUSCLE, "muscle")

// One layer of tissue: its part of a mesh, and its materials.
typedef struct cau_layer_def {
	char name[CAU_NAME_BYTES]; // name of the layer
	int kind;                  // CAU_LAYER_*
	int tissue;                // CAU_LIVING_*
	double perfusion;          // blood flow of the layer, relative to that of living tissue
	double coagulated_tear;    // energy of a tear in coagulated tissue, relative to fresh tissue
	double viscosity_s;        // retardation time: viscosity over stiffness; not used for LINKS
	char mesh[CAU_NAME_BYTES]; // name of the mesh, for FASCIA, FAT, and MEMBRANE without `of`
	char of[CAU_NAME_BYTES];   // MEMBRANE: name of a fat layer. LINKS: name of the upper layer
	char to[CAU_NAME_BYTES];   // LINKS: name of the lower layer
	double fibre[3];           // material direction if the mesh has no UV; FAT: first material axis
	int32_t material_count;    // at least 1; materials[0] is the default
	cau_sheet_material sheet[CAU_MAX_MATERIALS]; // FASCIA, MEMBRANE
	cau_fat_material fat[CAU_MAX_MATERIALS];     // FAT
	cau_link_material link;                      // LINKS
} cau_layer_def;

// ---- pins and other choices of vertices -------------------------------------------------------
#define CAU_SELECT_TABLE(X)                                                                        \
	X(RIM, "rim")       /* vertices on an edge that only one triangle of the sheet `layer` has */  \
	X(BOX, "box")       /* rest position inside [least_m, most_m] */                               \
	X(SPHERE, "sphere") /* rest position within radius_m of center_m */                            \
	X(NEAREST, "nearest") /* the one vertex nearest to center_m */

// A selection of vertices by their rest positions.
typedef struct cau_selection {
	int kind;                   // CAU_SELECT_*
	char layer[CAU_NAME_BYTES]; // name of a layer; empty: any layer
	double least_m[3];          // BOX: corner with the least coordinates
	double most_m[3];           // BOX: corner with the greatest coordinates
	double center_m[3];         // SPHERE: centre; NEAREST: the point
	double radius_m;            // radius of the SPHERE
} cau_selection;

// ---- tools ----------------------------------------------------------------------------------
// The shapes of tools. The columns are: code; word in JSON; whether the tool has a hot part;
// whether it has jaws that grasp; description. Frames name a shape by its entry's number, so new
// entries come last. The constant cau_shape_`word` in core/tool has the functions of the shape
// `word`, as its signed distances.
#define CAU_TOOL_SHAPE_TABLE(X)                                                                    \
	X(SPHERE, sphere, true, false, "hot ball at the tip, cold shaft")                              \
	X(CAPSULE, capsule, true, false, "hot needle, cold shaft")                                     \
	X(HOOK, hook, true, false, "monopolar L hook: hot foot and heel, cold shaft")                  \
	X(SPATULA, spatula, true, false, "hot flat blade, cold shaft")                                 \
	X(BIPOLAR, bipolar, true, true, "two jaws that close, hot inner faces")                        \
	X(SHEARS, shears, true, true, "ultrasonic: one hot blade, one cold clamping jaw")              \
	X(GRASPER, grasper, false, true, "two cold jaws")

// Sizes of a tool, in the tool's own frame: the tip is at the origin, the shaft along +z, and jaws
// open in x.
#define CAU_TOOL_TABLE(X)                                                                          \
	X(hot_radius_m, 3e-3, 2e-4, 0.05, "m", "radius of the hot part")                               \
	X(tip_length_m, 8e-3, 1e-3, 0.1, "m", "length of needle, hook foot, blade or jaws")            \
	X(shaft_radius_m, 2.5e-3, 2e-4, 0.05, "m", "radius of the shaft")                              \
	X(shaft_length_m, 0.12, 1e-3, 1.0, "m", "length of the shaft")                                 \
	X(jaw_open_rad, 0.6, 0.05, 1.5, "rad", "angle between open jaws")                              \
	X(temperature_c, 170.0, 0.0, 1500.0, "degC", "temperature of the hot part while energized")    \
	X(grid_cells, 16.0, 8.0, 64.0, "1", "nodes of the heat grid along each axis")                  \
	X(grid_step_m, 1e-3, 5e-5, 0.01, "m",                                                          \
	  "spacing of the heat grid; at most the smallest radius of the hot part")                     \
	X(diffusivity_m2_s, 4.2e-6, 0.0, 1e-3, "m^2/s",                                                \
	  "thermal diffusivity of the heat grid (alpha of eq. 18)")                                    \
	X(max_speed_m_s, 0.5, 1e-3, 5.0, "m/s",                                                        \
	  "largest speed of the tool; it follows faster commands at this speed")                       \
	X(max_turn_rad_s, 12.0, 0.1, 100.0, "rad/s", "largest angular speed of the tool")              \
	X(friction, 0.2, 0.0, 2.0, "1", "Coulomb coefficient of the cold parts")                       \
	X(drag_ns_m, 0.05, 0.0, 100.0, "N s/m", "viscous drag of the hot part on each vertex in it")   \
	X(grasp_stiffness_n_m, 200.0, 1.0, 1e6, "N/m",                                                 \
	  "stiffness of the spring that attaches one grasped vertex")                                  \
	X(slip_force_n, 2.0, 0.0, 1000.0, "N", "force above which a grasped vertex slips")             \
	X(force_max_n, 20.0, 0.01, 1000.0, "N",                                                        \
	  "largest force of the tool on tissue, and largest force sent to drivers")                    \
	X(close_force_n, 8.0, 0.01, 1000.0, "N", "largest force of the jaws on what they hold")        \
	X(power_w, 30.0, 0.0, 400.0, "W", "power to which the generator is set; for energy tissue")    \
	X(peak_v, 1150.0, 1.0, 10000.0, "V",                                                           \
	  "largest peak voltage; from 200 V the tool sparks and cuts")                                 \
	X(crest_factor, 1.4, 1.4, 20.0, "1", "peak voltage over root mean square voltage")             \
	X(current_max_a, 2.0, 0.01, 10.0, "A", "largest current, root mean square")                    \
	X(force_filter_s, 0.02, 0.0, 1.0, "s", "time constant of the force filter; 0: no filter")      \
	X(blade_heat_j_k, 0.0, 0.0, 100.0, "J/K",                                                      \
	  "heat capacity of the hot part, for energy tissue; 0: computed from its shape")              \
	X(blade_cooling_w_k, 0.0, 0.0, 1.0, "W/K",                                                     \
	  "heat flow from the hot part along the shaft, per kelvin; 0: computed from its shape")       \
	X(load_rise_off, 0.0, 0.0, 100.0, "1",                                                         \
	  "power ends when the load reaches this multiple of its minimum, until energy is turned off " \
	  "and on; 0: never")

// The position and rotation of a tool.
typedef struct cau_pose {
	double position_m[3]; // position of the tip, in the world
	double rotation[4];   // unit quaternion w, x, y, z: tool frame to world
} cau_pose;

// One tool: its shape, its sizes and its first pose.
typedef struct cau_tool_def {
	char name[CAU_NAME_BYTES]; // name of the tool
	int shape;                 // CAU_TOOL_*
	CAU_TOOL_TABLE(CAU_FIELD)
	cau_pose pose; // pose at creation
} cau_tool_def;

// ---- blood vessels -----------------------------------------------------------------------------

// A tube of blood within a layer of fat, with energy `tissue` (core/vessel/README.md).
#define CAU_VESSEL_TABLE(X)                                                                        \
	X(radius_m, 1.5e-3, 1e-4, 0.01, "m", "outer radius of the tube")                               \
	X(wall_m, 3e-4, 1e-5, 5e-3, "m", "thickness of the wall of the vessel; less than the radius")  \
	X(pressure_pa, 12000.0, 0.0, 40000.0, "Pa", "blood pressure at the first point of the vessel") \
	X(end_pressure_pa, 0.0, 0.0, 40000.0, "Pa",                                                    \
	  "pressure of blood that flows back from the last point of the vessel")                       \
	X(supply_m, 0.1, 1e-3, 10.0, "m",                                                              \
	  "length of a tube of this radius that leads the blood to the vessel")

// One vessel: its middle line, and its sizes and pressures.
typedef struct cau_vessel_def {
	char name[CAU_NAME_BYTES];  // name of the vessel
	char layer[CAU_NAME_BYTES]; // name of the layer of fat in which the vessel lies
	CAU_VESSEL_TABLE(CAU_FIELD)
	int32_t point_count; // 2 to CAU_MAX_VESSEL_POINTS
	// (point_count): points of the middle line at rest, in the world
	double points_m[CAU_MAX_VESSEL_POINTS][3];
} cau_vessel_def;

// ---- the scripted motions that benchmarks and demonstrations share ------------------------------
// A pull: the selected vertices are moved by `move_m` in `duration_s`.
typedef struct cau_pull_def {
	int32_t present;         // 1: the scene has a pull
	cau_selection selection; // vertices that are moved
	double move_m[3];        // displacement of the vertices
	double duration_s;       // duration of the motion
} cau_pull_def;

// A cut: the tool dwells at `from_m`, then moves to `to_m`.
typedef struct cau_cut_def {
	int32_t present;           // 1: the scene has a cut
	char tool[CAU_NAME_BYTES]; // name of the tool
	double from_m[3];          // position of the tip at the beginning
	double to_m[3];            // position of the tip at the end
	double rotation[4];        // rotation of the tool: unit quaternion w, x, y, z
	double dwell_s;            // time at from_m, with energy on
	double speed_m_s;          // speed of the motion
} cau_cut_def;

// ---- the scene --------------------------------------------------------------------------------
// A whole scene: the plain data from which a session is made.
typedef struct cau_scene_def {
	char name[CAU_NAME_BYTES];        // name of the scene
	char description[CAU_TEXT_BYTES]; // description for the user
	// folder in which relative mesh files are looked up; not in the JSON
	char directory[CAU_TEXT_BYTES];
	CAU_TIME_TABLE(CAU_FIELD)
	int32_t iterations;                      // most iterations of a step, 1 to 1000
	int solver;                              // CAU_SOLVER_*
	int precision;                           // CAU_PRECISION_* of the local and global steps
	int integrator;                          // CAU_INTEGRATOR_*: how a tick advances motion
	int parting;                             // CAU_PARTING_*: what heat parts
	int energy;                              // CAU_ENERGY_*: what an energized tool does to tissue
	uint64_t seed;                           // seed of all random numbers (ignition temperatures)
	double gravity_m_s2[3];                  // acceleration of gravity
	int32_t mesh_count;                      // at most CAU_MAX_MESHES
	cau_mesh_def meshes[CAU_MAX_MESHES];     // (mesh_count)
	int32_t layer_count;                     // at most CAU_MAX_LAYERS
	cau_layer_def layers[CAU_MAX_LAYERS];    // (layer_count)
	int32_t pin_count;                       // at most CAU_MAX_PINS
	cau_selection pins[CAU_MAX_PINS];        // (pin_count): selections of vertices that do not move
	int32_t tool_count;                      // at most CAU_MAX_TOOLS
	cau_tool_def tools[CAU_MAX_TOOLS];       // (tool_count)
	int32_t vessel_count;                    // at most CAU_MAX_VESSELS
	cau_vessel_def vessels[CAU_MAX_VESSELS]; // (vessel_count)
	cau_pull_def pull;                       // motion for measurements; may be absent
	cau_cut_def cut;                         // motion for measurements; may be absent
} cau_scene_def;                             // about 80 KiB: keep it on the heap

#undef CAU_FIELD

// How the global system of a step is solved: CAU_SOLVER_TABLE.
typedef enum cau_solver {
#define X(code, name) CAU_SOLVER_##code,
	CAU_SOLVER_TABLE(X)
#undef X
		CAU_SOLVER_COUNT
} cau_solver;
// The precision of the local and global steps: CAU_PRECISION_TABLE.
typedef enum cau_precision {
#define X(code, name) CAU_PRECISION_##code,
	CAU_PRECISION_TABLE(X)
#undef X
		CAU_PRECISION_COUNT
} cau_precision;
// How a tick advances motion: CAU_INTEGRATOR_TABLE.
typedef enum cau_integrator {
#define X(code, name) CAU_INTEGRATOR_##code,
	CAU_INTEGRATOR_TABLE(X)
#undef X
		CAU_INTEGRATOR_COUNT
} cau_integrator;
// What heat parts, edges or elements: CAU_PARTING_TABLE.
typedef enum cau_parting {
#define X(code, name) CAU_PARTING_##code,
	CAU_PARTING_TABLE(X)
#undef X
		CAU_PARTING_COUNT
} cau_parting;
// What an energized tool does to tissue: CAU_ENERGY_TABLE.
typedef enum cau_energy_law {
#define X(code, name) CAU_ENERGY_##code,
	CAU_ENERGY_TABLE(X)
#undef X
		CAU_ENERGY_COUNT
} cau_energy_law;
// Where a mesh comes from: CAU_MESH_SOURCE_TABLE.
typedef enum cau_mesh_source {
#define X(code, name) CAU_MESH_##code,
	CAU_MESH_SOURCE_TABLE(X)
#undef X
		CAU_MESH_SOURCE_COUNT
} cau_mesh_source;
// The law of fat: CAU_MODEL_TABLE.
typedef enum cau_model {
#define X(code, ...) CAU_MODEL_##code,
	CAU_MODEL_TABLE(X)
#undef X
		CAU_MODEL_COUNT
} cau_model;
// The kind of strain limit: CAU_LIMIT_TABLE.
typedef enum cau_limit {
#define X(code, name) CAU_LIMIT_##code,
	CAU_LIMIT_TABLE(X)
#undef X
		CAU_LIMIT_COUNT
} cau_limit;
// How a target is projected: CAU_PROJECTION_TABLE.
typedef enum cau_projection {
#define X(code, name) CAU_PROJECTION_##code,
	CAU_PROJECTION_TABLE(X)
#undef X
		CAU_PROJECTION_COUNT
} cau_projection;
// The kind of tissue: CAU_LAYER_TABLE.
typedef enum cau_layer_kind {
#define X(code, name) CAU_LAYER_##code,
	CAU_LAYER_TABLE(X)
#undef X
		CAU_LAYER_COUNT
} cau_layer_kind;
// The kind of living tissue, for heat and current: CAU_LIVING_TABLE.
typedef enum cau_living {
#define X(code, name) CAU_LIVING_##code,
	CAU_LIVING_TABLE(X)
#undef X
		CAU_LIVING_COUNT
} cau_living;
// How vertices are chosen: CAU_SELECT_TABLE.
typedef enum cau_select_kind {
#define X(code, name) CAU_SELECT_##code,
	CAU_SELECT_TABLE(X)
#undef X
		CAU_SELECT_COUNT
} cau_select_kind;
// The shape of a tool: CAU_TOOL_SHAPE_TABLE.
typedef enum cau_tool_shape_kind {
#define X(code, ...) CAU_TOOL_##code,
	CAU_TOOL_SHAPE_TABLE(X)
#undef X
		CAU_TOOL_SHAPE_COUNT
} cau_tool_shape_kind;
