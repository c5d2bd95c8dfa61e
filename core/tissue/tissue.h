// SPDX-License-Identifier: GPL-3.0-or-later
// A tissue at rest: the layers of a scene with one common vertex array (sections 3 and 5).
//
// All members except the materials stay the same for a session's life. Removal of elements and
// motion are in other modules.
#pragma once

#include <stdbool.h>

#include "base/memory.h"
#include "cautery/scene.h"
#include "cautery/status.h"
#include "mesh/edge_table.h"
#include "mesh/mesh.h"

// Regions of a layer's elements, as in the mesh file.
typedef struct cau_region_list {
	int32_t count;
	int32_t *region; // (count), ascending
} cau_region_list;

typedef struct cau_tissue_layer {
	cau_layer_def def; // name, kind, materials
	int32_t first_triangle, triangle_count;
	int32_t first_tetrahedron, tetrahedron_count;
	int32_t first_link, link_count;
	int32_t first_vertex, vertex_count; // its mesh's vertices; a fat's membrane has the fat's
	cau_region_list regions;
} cau_tissue_layer;

// gamma of Alexander's two-stage method of second order (SIAM J. Numer. Anal. 14, 1977), 1 -
// 1/sqrt(2). Two values make the method L-stable; this one has the smaller error. Both stages have
// M / (gamma dt)^2, so one matrix A serves both.
#define CAU_SDIRK2_GAMMA (1 - 0.70710678118654752440)

typedef struct cau_tissue {
	double inertia_s; // h of M / h^2 in eq. 4 and in A: the scene's step, or gamma times it
	bool viscous;     // true if some layer is viscous
	int32_t vertex_count;
	double *rest;    // m, (vertex_count x 3)
	double *mass;    // kg, (vertex_count), lumped
	uint8_t *pinned; // (vertex_count)

	int32_t layer_count;
	cau_tissue_layer *layer;
	cau_mesh_report *mesh_report; // a report for each of the scene's meshes

	int32_t triangle_count;
	int32_t *triangle;       // (triangle_count x 3)
	int32_t *triangle_layer; // layer of each triangle, (triangle_count)
	int32_t *triangle_material;
	double *triangle_frame;      // (triangle_count x 6): unit t_u, t_v (eq. 9)
	double *triangle_dm_inverse; // 1/m, (triangle_count x 4), row-major D_m'^-1 (eq. 10)
	double *triangle_area;       // m^2
	float *texture;              // (triangle_count x 3 x 2)

	int32_t tetrahedron_count;
	int32_t *tetrahedron; // (tetrahedron_count x 4)
	int32_t *tetrahedron_layer;
	int32_t *tetrahedron_material;
	double
		*tetrahedron_dm_inverse; // 1/m, (tetrahedron_count x 9), row-major; D_m columns X_i - X_0
	double *tetrahedron_volume;  // m^3

	int32_t link_count;
	int32_t *link; // (link_count x 2)
	int32_t *link_layer;
	double *link_length; // m

	int32_t hinge_count;       // hinges of sheets with bending stiffness
	int32_t *hinge_vertex;     // (hinge_count x 4): shared edge a, b, then the opposite vertices
	int32_t *hinge_triangle;   // (hinge_count x 2)
	double *hinge_coefficient; // (hinge_count x 4), sum 0: e = sum of c_i x_i
	double *hinge_weight;      // N/m

	cau_primitives primitives; // views of the arrays above
	cau_edge_table edges;
	cau_face_table faces;
} cau_tissue;

// Builds the tissue of a checked scene. The caller finishes it, also after an error.
cau_status cau_tissue_make(const cau_scene_def *scene, cau_arena *arena, cau_tissue *tissue,
                           cau_error *error);
void cau_tissue_finish(cau_tissue *tissue);

// Sets the bytes of the selected vertices in `chosen` (vertex_count) to 1. Returns their number, or
// -1 if the layer that the selection names does not exist.
int32_t cau_tissue_select(const cau_tissue *tissue, const cau_selection *selection,
                          uint8_t *chosen);

// Regions of a layer's elements (layers.c).
// Lists the regions of `count` elements. The list is in the arena's memory.
cau_status cau_region_list_make(cau_region_list *list, const int32_t *region, int32_t count,
                                cau_arena *arena, cau_error *error);
// Returns CAU_NOT_FOUND at `path`, with the existing regions, if the list lacks `region`.
cau_status cau_region_list_check(const cau_region_list *list, const char *layer, int32_t region,
                                 const char *path, cau_error *error);

// Layers and materials (element_map.c).
int32_t cau_tissue_find_layer(const cau_tissue *tissue, const char *name); // -1: no such layer

// Return the material of an element.
const cau_sheet_material *cau_triangle_material(const cau_tissue *tissue, int32_t triangle);
const cau_fat_material *cau_tetrahedron_material(const cau_tissue *tissue, int32_t tetrahedron);
// Returns the layer of a triangle, tetrahedron or link (CAU_PRIMITIVE_*).
int32_t cau_tissue_layer_of(const cau_tissue *tissue, int primitive, int32_t index);
const cau_heat_material *cau_layer_heat(const cau_tissue_layer *layer, int32_t material);

// Elements in the form that the system needs: maps G of rank r with a weight w. The
// first kinds are the primitives (mesh/edge_table.h), with the same numbers.
typedef enum cau_element_kind {
	CAU_ELEMENT_TRIANGLE = CAU_PRIMITIVE_TRIANGLE,
	CAU_ELEMENT_TETRAHEDRON = CAU_PRIMITIVE_TETRAHEDRON,
	CAU_ELEMENT_LINK = CAU_PRIMITIVE_LINK,
	CAU_ELEMENT_HINGE = CAU_PRIMITIVE_KINDS,
	CAU_ELEMENT_KINDS
} cau_element_kind;

typedef struct cau_element_map {
	int32_t vertex_count, rank;
	int32_t vertex[4];
	double coefficient[3][4]; // row r of G: sum over i of coefficient[r][i] x_i
	double weight;            // N m (triangle, tetrahedron; G in 1/m) or N/m (link, hinge)
} cau_element_map;

int32_t cau_tissue_element_count(const cau_tissue *tissue, int kind);
// Returns the vertices of a triangle, tetrahedron or link (CAU_PRIMITIVE_*); *count gets their
// number.
const int32_t *cau_tissue_vertices_of(const cau_tissue *tissue, int primitive, int32_t index,
                                      int *count);
void cau_tissue_element_map(const cau_tissue *tissue, int kind, int32_t index,
                            cau_element_map *map);
// Returns |G|^2 / vertex count of an element, 1/m^2 (1 for links and hinges' own G).
double cau_element_map_scale(const cau_element_map *map);

// Computes Lame's first and second parameter for small strain, Pa.
void cau_fat_lame(const cau_fat_material *material, double *lambda, double *mu);
