// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a solid of tetrahedra from a closed surface or from a segmentation. The result is the bytes
// of a Gmsh file.
//
//     #include "cautery/solid.h"
//
//     // Writes the solid inside a surface, or of a segmentation, to `out`.
//     static cau_status fill_file(const char *file, FILE *out, cau_error *error)
//     {
//         cau_solid solid;
//         cau_solid_wish wish = {.file = file};
//         cau_status status = cau_solid_make(&wish, &solid, error);
//         if (!status) {
//             fputs(solid.text, stderr);
//             fwrite(solid.bytes, 1, solid.byte_count, out);
//         }
//         cau_solid_finish(&solid);
//         return status;
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
	CAU_SOLID_LABEL_MAX = 63,     // largest number of labels of a segmentation
	CAU_SOLID_TEXT_BYTES = 16384, // bytes of the report, at most a line for each label
};

// Input of cau_solid_make.
typedef struct cau_solid_wish {
	const char *file;  // path of a file; if `bytes` is set, a name for messages
	const void *bytes; // content of the file; NULL: `file` is read
	size_t byte_count; // number of `bytes`
	double edge;       // target length of an edge, in units of the file; 0: chosen automatically
	// Target number of tetrahedra, if the edge is chosen automatically; 0: 8,000.
	int32_t tetrahedra;
	const char *labels; // labels of a segmentation to keep, for example "1,3"; NULL: all but 0
	bool strict;        // refuse a surface that is open, or that has triangles that would be turned
	// Reports the finished share, 0 to 1; may be NULL.
	void (*progress)(void *user, const char *stage, double share);
	void *user; // passed to `progress`
} cau_solid_wish;

// The result of cau_solid_make. Its owner calls cau_solid_finish.
typedef struct cau_solid {
	unsigned char *bytes; // a binary Gmsh 2.2 file; its regions are the labels, with their names
	size_t byte_count;    // number of `bytes`
	// Metres in one unit; 0.001 for a segmentation; 0: the unit of the surface.
	double unit_m;
	char text[CAU_SOLID_TEXT_BYTES]; // the report, one fact a line
} cau_solid;

// Whether the bytes are a volume of voxels (NRRD, NIfTI 1 and 2, packed or not).
bool cau_solid_is_volume(const void *bytes, size_t byte_count);

// Makes the tetrahedra. Errors: those of reading a mesh. CAU_BAD_MESH if there is no inside.
// CAU_BAD_VALUE at "edge" or "labels", or if a chosen edge would need more than sixteen times the
// target number of tetrahedra. CAU_LIMIT at "edge" if it needs too many cells. The caller finishes
// *solid, also after an error. Threads: any; deterministic.
cau_status cau_solid_make(const cau_solid_wish *wish, cau_solid *solid, cau_error *error);
// Frees the bytes of the solid.
void cau_solid_finish(cau_solid *solid);

#ifdef __cplusplus
}
#endif
