// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh that grows while a file is read, and the readers that fill it. Failures go to the scan,
// which reports where.
#pragma once

#include "mesh/mesh.h"
#include "mesh/scan.h"

// Shapes of cells. Corners are numbered as Gmsh and VTK number them.
typedef enum cau_shape {
	CAU_SHAPE_TRIANGLE,
	CAU_SHAPE_QUADRANGLE,
	CAU_SHAPE_TETRAHEDRON,
	CAU_SHAPE_PYRAMID,
	CAU_SHAPE_WEDGE,
	CAU_SHAPE_HEXAHEDRON,
	CAU_SHAPE_COUNT, // number of shapes; as a shape it means: no shape
} cau_shape;

enum { CAU_CORNERS_MAX = 8, CAU_REGION_NAMES_MAX = 4096 };

// A cell that is split after all vertices are known.
typedef struct cau_cell {
	int32_t shape; // a cau_shape
	int32_t region;
	int32_t vertex[CAU_CORNERS_MAX];
} cau_cell;

// The name of a region in the file.
typedef struct cau_region_name {
	int32_t dimension; // dimension of its elements: 2 or 3; 0: both
	int32_t region;
	cau_word name;
} cau_region_name;

typedef struct cau_mesh_builder {
	cau_scan *scan;         // borrowed
	cau_mesh_report report; // format, kinds, and counts of split and reduced elements
	cau_mesh mesh;          // has texture coordinates of the triangles if `texture` is set
	bool texture;
	int32_t vertex_capacity;
	int32_t triangle_capacity;
	int32_t tetrahedron_capacity;
	cau_cell *cell; // (cell_count)
	int32_t cell_count;
	int32_t cell_capacity;
	cau_region_name *name; // (name_count)
	int32_t name_count;
	int32_t name_capacity;
} cau_mesh_builder;

// Returns the number of corners of a shape.
int cau_shape_corners(cau_shape shape);
// Returns the name of a shape in the plural: "triangles", "hexahedra", ...
const char *cau_shape_name(cau_shape shape);

// Appends a vertex. Fails if a coordinate is not finite.
void cau_mesh_builder_vertex(cau_mesh_builder *builder, const double position[3]);
// Appends a triangle. Its vertices must already be in the mesh. `texture` (3 x 2) or NULL. Counts
// no kind in the report.
void cau_mesh_builder_triangle(cau_mesh_builder *builder, const int32_t vertex[3], int32_t region,
                               const double *texture);
// Appends a tetrahedron. Its vertices must already be in the mesh. Counts no kind in the report.
void cau_mesh_builder_tetrahedron(cau_mesh_builder *builder, const int32_t vertex[4],
                                  int32_t region);
// Appends a polygon of at least three corners as triangles. `texture` (count x 2) or NULL. Counts
// the polygon's kind in the report.
void cau_mesh_builder_polygon(cau_mesh_builder *builder, const int32_t *vertex, int32_t count,
                              int32_t region, const double *texture);
// Appends a cell of any shape. The report counts the cell under the name `kind`. `reduced`: the
// cell had nodes other than its corners.
void cau_mesh_builder_cell(cau_mesh_builder *builder, cau_shape shape, const int32_t *vertex,
                           int32_t region, const char *kind, bool reduced);
// Counts skipped elements under the name `kind`.
void cau_mesh_builder_skip(cau_mesh_builder *builder, const char *kind, int64_t count);
// Appends the name of a region.
void cau_mesh_builder_name(cau_mesh_builder *builder, int32_t dimension, int32_t region,
                           cau_word name);
// Replaces every region r by of[r], or by 0 if r is not in [0, count).
void cau_mesh_builder_map_regions(cau_mesh_builder *builder, const int32_t *of, int64_t count);

void cau_mesh_builder_finish(cau_mesh_builder *builder); // frees everything

// Cuts a polygon into `count` - 2 triangles and writes the indices of their corners to `triangle`.
// A polygon that is convex as seen from its first corner becomes a fan around that corner. So does
// every polygon of more than 4096 corners. Any other polygon is cut by removing ears. `position`
// has the positions of all vertices. Returns false if memory ran out.
bool cau_polygon_cut(const double *position, const int32_t *vertex, int32_t count,
                     int32_t (*triangle)[3]);

// ---- node numbers
// Maps the node numbers of a file to vertices. Node numbers may be sparse and in any order.
typedef struct cau_node_map {
	struct cau_node {
		int64_t number;
		int32_t vertex;
	} * node;
	int32_t count;
	int32_t capacity;
} cau_node_map;

// Appends a node. Its vertex is the number of nodes before this call. Failures go to the scan.
void cau_node_map_add(cau_node_map *map, int64_t number, cau_scan *scan);
// Prepares the map for cau_node_map_find. Fails if a number occurs twice.
void cau_node_map_seal(cau_node_map *map, cau_scan *scan);
// Returns the vertex of a node, or -1.
int32_t cau_node_map_find(const cau_node_map *map, int64_t number);
void cau_node_map_finish(cau_node_map *map);

// ---- splitting
// Splits the builder's cells into triangles and tetrahedra. Cells that share a quadrangle split it
// in the same way.
void cau_cell_split(cau_mesh_builder *builder);

// ---- the readers of all formats
// Each reader reads builder->scan into the builder, and returns the scan's status.
cau_status cau_mesh_read_gmsh(cau_mesh_builder *builder); // 1, 2.x, 4.0, 4.1; text, binary
cau_status cau_mesh_read_vtk(cau_mesh_builder *builder);  // legacy VTK; text, binary
cau_status cau_mesh_read_vtu(cau_mesh_builder *builder);  // VTU and VTP (XML)
cau_status cau_mesh_read_obj(cau_mesh_builder *builder);  // Wavefront OBJ
cau_status cau_mesh_read_stl(cau_mesh_builder *builder);  // STL; text
cau_status cau_mesh_read_stl_binary(cau_mesh_builder *builder);
cau_status cau_mesh_read_ply(cau_mesh_builder *builder);    // PLY; text, binary
cau_status cau_mesh_read_medit(cau_mesh_builder *builder);  // Medit .mesh
cau_status cau_mesh_read_meshb(cau_mesh_builder *builder);  // Medit .meshb
cau_status cau_mesh_read_tetgen(cau_mesh_builder *builder); // TetGen .node, then .ele or .face
cau_status cau_mesh_read_usda(cau_mesh_builder *builder);   // UsdGeom.TetMesh and Mesh as text

// ---- report
// Lists the regions that were read, with their names in the file.
void cau_mesh_report_regions(const cau_mesh_builder *builder, cau_mesh_report *report);
