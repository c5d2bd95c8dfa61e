// SPDX-License-Identifier: GPL-3.0-or-later
// Functions that read the parts of a legacy VTK file. All failures go to the scan.
#pragma once

#include "mesh/mesh_builder.h"

typedef struct cau_vtk {
	cau_scan *scan;
	cau_mesh_builder *builder;
	bool offsets; // cells have the format of version 5.1 and later: OFFSETS and CONNECTIVITY
	bool has_points;
	// Cells of all sections so far; an element's region is its cell index until the end.
	int32_t cell_count;
	// Corners of the cells in CELLS, whose types are not read yet, (corner_count).
	int64_t *corner;
	int64_t *first; // (waiting_count + 1): start of each waiting cell in `corner`
	int64_t waiting_count;
	int32_t *cell_region; // (region_count), or NULL
	int64_t region_count;
} cau_vtk;

// A type of numbers that the format names.
typedef struct cau_vtk_type {
	const char *name;
	int bytes;
	enum { CAU_VTK_SIGNED, CAU_VTK_UNSIGNED, CAU_VTK_REAL } kind;
} cau_vtk_type;

// Reads the name of a type. Returns NULL if the type is unknown; the scan has then failed.
const cau_vtk_type *cau_vtk_read_type(cau_scan *scan);
// Reads one number of a type.
double cau_vtk_read_number(cau_scan *scan, const cau_vtk_type *type, const char *what);
// Moves to the start of binary numbers: the line after the words that announce them.
void cau_vtk_start_numbers(cau_scan *scan);

void cau_vtk_read_points(cau_vtk *vtk);
// Reads CELLS of an unstructured grid. CELL_TYPES must follow.
void cau_vtk_read_cells(cau_vtk *vtk);
// Reads CELL_TYPES and adds the cells that CELLS announced.
void cau_vtk_read_cell_types(cau_vtk *vtk);
// Reads POLYGONS or TRIANGLE_STRIPS of POLYDATA.
void cau_vtk_read_polygons(cau_vtk *vtk, int type);
// Counts the other cells of POLYDATA.
void cau_vtk_read_other_cells(cau_vtk *vtk, const char *kind);

// Whether this name is used for the region of cells.
bool cau_vtk_is_region_name(cau_word name);

// Begins CELL_DATA or POINT_DATA. Returns how many items follow.
int64_t cau_vtk_read_data_count(cau_vtk *vtk);
// Reads the attribute with this keyword. If `cells`, the attribute may be the region of cells.
// Returns false if the keyword is unknown.
bool cau_vtk_read_attribute(cau_vtk *vtk, cau_word keyword, int64_t item_count, bool cells);
