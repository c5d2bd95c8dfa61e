// SPDX-License-Identifier: GPL-3.0-or-later
// A scene around a mesh file: pins, layers, tools and a unit, so that the tissue stands and can be
// grasped and cut.
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

// ---- the report: what was read, passed over and mended, and what the mesh is. Command line, wire,
// log and viewer show the same one.
enum {
	CAU_MESH_KIND_MAX = 24,     // kinds of elements that a report lists
	CAU_MESH_REGION_MAX = 64,   // regions that a report lists
	CAU_MESH_QUALITY_BINS = 10, // of the histogram of qualities
	CAU_MESH_NAME_BYTES = 48,   // of the name of a region, with its zero
	CAU_MESH_TEXT_BYTES = 4096, // of a report as text
};

// Elements of one kind, as the file has them.
typedef struct cau_mesh_kind {
	char name[40];  // "hexahedra"
	int64_t read;   // became elements of the mesh
	int64_t passed; // were passed over
} cau_mesh_kind;

// Elements of one region. Surfaces and volumes have numbers of their own.
typedef struct cau_mesh_region {
	int32_t dimension;              // 2: triangles, 3: tetrahedra
	int32_t region;                 // its number in the file
	int32_t element_count;          // after mending
	char name[CAU_MESH_NAME_BYTES]; // of the file, or ""
} cau_mesh_region;

// What mending did: the field, whether `strict` refuses it, and the words of the report.
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

// What a file held and what became of it.
typedef struct cau_mesh_report {
	char format[32];                       // "Gmsh 4.1", or "" for a generated mesh
	int64_t vertices_read;                 // in the file
	int32_t kind_count;                    // kinds of elements, listed
	cau_mesh_kind kind[CAU_MESH_KIND_MAX]; // (kind_count)
#define X(field, strict, words) int32_t field;
	CAU_MESH_MEND_TABLE(X)
#undef X
	// The mesh after mending.
	int32_t vertex_count, triangle_count, tetrahedron_count;
	int32_t component_count; // connected pieces
	int32_t open_edge_count; // edges of one triangle only; of meshes without tetrahedra
	double opening;          // area of the holes that they surround, over the surface's area
	int32_t region_count;    // of all regions, listed or not
	cau_mesh_region region[CAU_MESH_REGION_MAX]; // the first of them
	double least_m[3], most_m[3];                // bounding box
	double unit_m;                               // metres in one unit of the file, as used
	int32_t unit_guessed;                        // 1: neither scene nor file states the unit
	double proposed_unit_m; // a unit that makes the size that of tissue; 0: none is needed
	// Elements by quality, (0 to 0.1, ... 0.9 to 1): the mean ratio, 1 for a regular element.
	int32_t quality[CAU_MESH_QUALITY_BINS];
	double least_quality; // of all elements
	double mean_edge_m;   // root mean square, of the edges of all elements
} cau_mesh_report;

// ---- the scene
// What cau_mesh_scene makes a scene of.
typedef struct cau_mesh_wish {
	const char *file;   // path of a file; with bytes, the name of the upload
	const void *bytes;  // NULL: `file` is read
	size_t byte_count;  // of `bytes`
	double unit_m;      // metres in one unit; 0: guessed where it is clear
	int32_t layer_kind; // CAU_LAYER_FAT or CAU_LAYER_FASCIA; -1: fat where there are tetrahedra
	int32_t strict;     // refuse what would have to be mended
	const char *pins;   // sides whose outermost tenth is pinned, of bottom, top, left, right, front
	                    // and back, with commas, or "none"; NULL or "": chosen
} cau_mesh_wish;

// A surface whose holes have no more than this share of its area is nearly closed: it has an
// inside.
#define CAU_NEARLY_CLOSED 0.1

// Reads the mesh and makes a scene around it: its lowest tenth pinned, or the rim of an open sheet;
// a material for each of the first regions; a hot ball and a grasper above it; no gravity, as a
// scanned organ has its shape under its weight already. Errors: as for reading; CAU_BAD_MESH at
// "unit_m" with a proposal where the unit is not clear; CAU_BAD_MESH at "as" where the file lacks
// the elements of the layer; CAU_BAD_VALUE at "pin". Threads: any.
cau_status cau_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_mesh_report *report,
                          cau_error *error);

// The report in words, one fact a line.
void cau_mesh_report_text(const cau_mesh_report *report, char bytes[CAU_MESH_TEXT_BYTES]);

#ifdef __cplusplus
}
#endif
