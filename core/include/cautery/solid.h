// SPDX-License-Identifier: GPL-3.0-or-later
// From a closed surface, or from a segmentation, to a solid of tetrahedra: the bytes of a Gmsh
// file.
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
	CAU_SOLID_LABEL_MAX = 63,     // labels of one segmentation
	CAU_SOLID_TEXT_BYTES = 16384, // of the report: a line for each label at most
};

// What cau_solid_make fills.
typedef struct cau_solid_wish {
	const char *file;   // path of a file; with bytes, a name for messages
	const void *bytes;  // NULL: `file` is read
	size_t byte_count;  // of `bytes`
	double edge;        // target length of an edge, in units of the file; 0: chosen
	int32_t tetrahedra; // aimed at where the edge is chosen; 0: 8,000
	const char *labels; // "1,3": labels of a segmentation to keep; NULL: all but 0
	bool strict;        // refuse a surface that is open, or has triangles that would be turned
	void (*progress)(void *user, const char *stage, double share); // 0 to 1; may be NULL
	void *user;                                                    // passed to `progress`
} cau_solid_wish;

// A solid. Its owner calls cau_solid_finish.
typedef struct cau_solid {
	unsigned char *bytes; // a Gmsh 2.2 file, binary; regions are the labels, with their names
	size_t byte_count;    // of `bytes`
	double unit_m;        // metres in its unit: of a segmentation 0.001; 0: that of the surface
	char text[CAU_SOLID_TEXT_BYTES]; // the report, one fact a line
} cau_solid;

// Whether these bytes are a volume of voxels (NRRD, NIfTI 1 and 2, packed or not).
bool cau_solid_is_volume(const void *bytes, size_t byte_count);

// Makes the tetrahedra. Errors: as for reading a mesh; CAU_BAD_MESH where nothing is inside,
// CAU_BAD_VALUE at "edge" or "labels", or where a chosen edge would need more than sixteen times
// the tetrahedra that are aimed at, CAU_LIMIT at "edge" where it asks for too many cells. The
// caller finishes *solid, on failure too. Threads: any; deterministic.
cau_status cau_solid_make(const cau_solid_wish *wish, cau_solid *solid, cau_error *error);
// Frees the bytes.
void cau_solid_finish(cau_solid *solid);

#ifdef __cplusplus
}
#endif
