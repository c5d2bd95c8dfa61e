// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a legacy VTK file. All failures go to the scan.
#pragma once

#include "mesh/mesh_builder.h"

typedef struct cau_vtk {
	cau_scan *scan;
	cau_mesh_builder *builder;
	bool offsets; // cells as from version 5.1: OFFSETS and CONNECTIVITY
	bool has_points;
	int32_t cell_count; // of all sections so far; an element's region is its cell until the end
	int64_t *corner;    // cells of CELLS that wait for their types, (corner_count)
	int64_t *first;     // (waiting_count + 1): where each starts in `corner`
	int64_t waiting_count;
	int32_t *cell_region; // (region_count), or NULL
	int64_t region_count;
} cau_vtk;

// Kinds of numbers that the format names.
typedef struct cau_vtk_type {
	const char *name;
	int bytes;
	enum { CAU_VTK_SIGNED, CAU_VTK_UNSIGNED, CAU_VTK_REAL } kind;
} cau_vtk_type;

// Reads the name of a type. NULL: it is not known, and the scan has failed.
const cau_vtk_type *cau_vtk_read_type(cau_scan *scan);
// Reads one number of a type.
double cau_vtk_read_number(cau_scan *scan, const cau_vtk_type *type, const char *what);
// Binary numbers start on the line after the words that announce them.
void cau_vtk_start_numbers(cau_scan *scan);

void cau_vtk_read_points(cau_vtk *vtk);
// CELLS of an unstructured grid, then CELL_TYPES.
void cau_vtk_read_cells(cau_vtk *vtk);
void cau_vtk_read_cell_types(cau_vtk *vtk);
// POLYGONS and TRIANGLE_STRIPS of POLYDATA, and its other cells, which are only counted.
void cau_vtk_read_polygons(cau_vtk *vtk, int type);
void cau_vtk_read_other_cells(cau_vtk *vtk, const char *kind);

// Whether the regions of cells may have this name.
bool cau_vtk_is_region_name(cau_word name);

// CELL_DATA or POINT_DATA has begun: how many items follow.
int64_t cau_vtk_read_data_count(cau_vtk *vtk);
// One attribute by its keyword. `cells`: it may be the region. False: the keyword is not known.
bool cau_vtk_read_attribute(cau_vtk *vtk, cau_word keyword, int64_t item_count, bool cells);
