// SPDX-License-Identifier: GPL-3.0-or-later
// Parts that the readers of VTK's files use.
#pragma once

#include "mesh/mesh_builder.h"

// ---- types of cells, for legacy files and XML files
enum { CAU_VTK_STRIP = 6, CAU_VTK_POLYGON = 7 };

// Adds a cell of one of VTK's types, or counts it as skipped. The region of the new elements is
// `cell`, the cell's index, until the regions of the file are known. Fails if the cell has points
// that do not exist.
void cau_vtk_add_cell(cau_mesh_builder *builder, int64_t type, const int64_t *corner,
                      int64_t corners, int32_t cell);

// Whether this name is used for the region of cells.
bool cau_vtk_is_region_name(cau_word name);

// ---- arrays of numbers in XML files
// They are text, base64 or appended bytes, uncompressed or compressed by zlib. Format: "VTK File
// Formats", XML formats.

// Properties that all arrays of a file share.
typedef struct cau_vtu_coding {
	cau_scan *scan;   // for failures
	int header_bytes; // bytes of each number before the data: 4 or 8
	bool swap;
	bool zlib;
	const unsigned char *appended; // data after the underscore, (appended_bytes), or NULL
	size_t appended_bytes;
	bool appended_base64;
} cau_vtu_coding;

typedef struct cau_vtu_array {
	cau_word type;   // such as "Float32"
	cau_word format; // "ascii", "binary" or "appended"
	int64_t offset;  // position in the appended data
	const unsigned char *text;
	size_t text_bytes; // bytes between the tags
} cau_vtu_array;

// Returns all numbers of an array, which the caller frees. Returns NULL if the scan has failed or
// if there are no numbers.
double *cau_vtu_numbers(const cau_vtu_coding *coding, const cau_vtu_array *array, int64_t *count);
