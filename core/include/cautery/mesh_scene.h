// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a scene from a mesh file: it adds pins, layers, tools and a unit of length, so that the
// tissue is held and can be grasped and cut.
//
//     #include "cautery/mesh_scene.h"
//
//     // Fills *scene with a scene around `file`, and prints what became of the file.
//     static cau_status open_anatomy(const char *file, cau_scene_def *scene, cau_error *error)
//     {
//         static cau_mesh_report report;
//         char text[CAU_MESH_TEXT_BYTES];
//         cau_mesh_wish wish = {.file = file, .layer_kind = -1};
//         cau_status status = cau_mesh_scene(&wish, scene, &report, error);
//         if (!status) {
//             cau_mesh_report_text(&report, text);
//             fputs(text, stderr);
//         }
//         return status;
//     }
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "cautery/scene.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

// ---- the report: the parts that were read, skipped and mended, and the contents of the mesh. The
// command line, the wire protocol, the log and the viewer show the same report.
enum {
	CAU_MESH_KIND_MAX = 24,     // largest number of kinds of elements in a report
	CAU_MESH_REGION_MAX = 64,   // largest number of regions in a report
	CAU_MESH_QUALITY_BINS = 10, // bins of the histogram of qualities
	CAU_MESH_NAME_BYTES = 48,   // bytes of a region's name, with its final zero
	CAU_MESH_TEXT_BYTES = 4096, // bytes of a report as text
};

// Counts of elements of one kind, as the file has them.
typedef struct cau_mesh_kind {
	char name[40];  // for example "hexahedra"
	int64_t read;   // elements that became elements of the mesh
	int64_t passed; // elements that were skipped
} cau_mesh_kind;

// Elements of one region. Surfaces and volumes are numbered separately.
typedef struct cau_mesh_region {
	int32_t dimension;              // 2: region of triangles; 3: region of tetrahedra
	int32_t region;                 // the region's number in the file
	int32_t element_count;          // number of elements after mending
	char name[CAU_MESH_NAME_BYTES]; // name in the file, or ""
} cau_mesh_region;

// The changes that mending counts. The columns are: member of cau_mesh_report; whether `strict`
// refuses the change; its text in the report.
#define CAU_MESH_MEND_TABLE(X)                                                                     \
	X(duplicate_vertices, 1, "duplicate vertices merged")                                          \
	X(inverted_tetrahedra, 1, "inverted elements turned")                                          \
	X(degenerate_triangles, 1, "degenerate triangles left out")                                    \
	X(degenerate_tetrahedra, 1, "degenerate tetrahedra left out")                                  \
	X(duplicate_elements, 1, "repeated elements left out")                                         \
	X(third_tetrahedra, 1, "tetrahedra left out that were the third at a face")                    \
	X(degenerate_textures, 1, "degenerate texture triangles left out")                             \
	X(split_polygons, 1, "quadrangles and polygons split into triangles")                          \
	X(split_hexahedra, 1, "hexahedra split into tetrahedra")                                       \
	X(split_wedges, 1, "wedges split into tetrahedra")                                             \
	X(split_pyramids, 1, "pyramids split into tetrahedra")                                         \
	X(reduced_elements, 1, "higher-order elements reduced to their corners")                       \
	X(unused_vertices, 0, "unused vertices left out")

// The report: the contents of the file, the parts that were skipped and mended, and the contents
// of the mesh.
typedef struct cau_mesh_report {
	char format[32];                       // for example "Gmsh 4.1"; "" for a generated mesh
	int64_t vertices_read;                 // vertices in the file
	int32_t kind_count;                    // number of listed kinds of elements
	cau_mesh_kind kind[CAU_MESH_KIND_MAX]; // (kind_count): counts for each kind
#define X(field, strict, words) int32_t field;
	CAU_MESH_MEND_TABLE(X)
#undef X
	// The mesh after mending:
	int32_t vertex_count, triangle_count, tetrahedron_count;
	int32_t component_count; // connected pieces of the mesh
	int32_t open_edge_count; // edges of one triangle only; counted if the mesh has no tetrahedra
	double opening;          // area of the holes inside these edges, over the surface's area
	int32_t region_count;    // number of all regions, listed or not
	cau_mesh_region region[CAU_MESH_REGION_MAX]; // the first regions
	double least_m[3], most_m[3];                // corners of the bounding box
	double unit_m;                               // metres in one unit of the file, as used
	// 1: the unit was guessed, because neither the scene nor the file states it.
	int32_t unit_guessed;
	// A unit with which the mesh has the size of tissue; 0: no proposal is needed.
	double proposed_unit_m;
	// Number of elements by quality (0 to 0.1, ... 0.9 to 1). Quality is the mean ratio, 1 for a
	// regular element.
	int32_t quality[CAU_MESH_QUALITY_BINS];
	double least_quality; // least quality of an element
	double mean_edge_m;   // root mean square of the lengths of all elements' edges
} cau_mesh_report;

// ---- the scene
// Input of cau_mesh_scene.
typedef struct cau_mesh_wish {
	const char *file;  // path of a file; if `bytes` is set, the name of the upload
	const void *bytes; // content of the file; NULL: `file` is read
	size_t byte_count; // number of `bytes`
	double unit_m;     // metres in one unit of the file; 0: guessed if it is clear
	// CAU_LAYER_FAT or CAU_LAYER_FASCIA; -1: fat if there are tetrahedra, else fascia.
	int32_t layer_kind;
	int32_t strict; // 1: a mesh that needs mending is refused
	// Sides whose outermost tenth is pinned: bottom, top, left, right, front, back, separated by
	// commas, or "none"; NULL or "": chosen automatically.
	const char *pins;
} cau_mesh_wish;

// Largest area of the holes of a nearly closed surface, as a share of its area. A nearly closed
// surface has an inside.
#define CAU_NEARLY_CLOSED 0.1

// Reads the mesh and makes a scene around it. The scene has:
// - pins at its lowest tenth, or at the rim of an open sheet;
// - a material for each of the first regions;
// - a hot ball and a grasper above it;
// - no gravity, because the shape of a scanned organ already includes its weight.
// Errors: those of reading a mesh. CAU_BAD_MESH at "unit_m", with a proposal, if the unit is not
// clear. CAU_BAD_MESH at "as" if the file lacks the elements of the layer. CAU_BAD_VALUE at "pin".
// Threads: any.
cau_status cau_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_mesh_report *report,
                          cau_error *error);

// Writes the report as text, one fact a line.
void cau_mesh_report_text(const cau_mesh_report *report, char bytes[CAU_MESH_TEXT_BYTES]);

#ifdef __cplusplus
}
#endif
