// SPDX-License-Identifier: GPL-3.0-or-later
// Reads points and cells of a legacy VTK file.
#include <stdlib.h>

#include "cautery/assert.h"
#include "mesh/mesh_memory.h"
#include "mesh/vtk_part.h"
#include "mesh/vtk_types.h"

// Cells as lists of points: the points of cell i are corner[first[i]] .. corner[first[i + 1]).
typedef struct cell_list {
	int64_t count;
	int64_t *first;
	int64_t *corner;
} cell_list;

static void finish_list(cell_list *list)
{
	free(list->first);
	free(list->corner);
	*list = (cell_list){0};
}

void cau_vtk_read_points(cau_vtk *vtk)
{
	cau_scan *scan = vtk->scan;
	if (vtk->has_points)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file has two sections POINTS");
	vtk->has_points = true;
	int64_t count = cau_scan_count(scan, "number of points", 3);
	const cau_vtk_type *type = cau_vtk_read_type(scan);
	cau_vtk_start_numbers(scan);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		double position[3];
		for (int c = 0; c < 3; c++)
			position[c] = cau_vtk_read_number(scan, type, "a coordinate");
		cau_mesh_builder_vertex(vtk->builder, position);
	}
}

static int64_t *read_indices(cau_scan *scan, const char *what, int64_t count, int bytes)
{
	CAU_ASSERT(bytes == 4 || bytes == 8, "%s of %d bytes", what, bytes);
	cau_scan_check_count(scan, what, count, scan->binary ? bytes : 1);
	if (scan->status)
		return NULL;
	int64_t *index = cau_mesh_array((size_t)count, sizeof *index);
	if (!index) {
		cau_scan_fail(scan, CAU_NO_MEMORY, "no memory for %lld indices", (long long)count);
		return NULL;
	}
	for (int64_t i = 0; i < count && !scan->status; i++)
		index[i] = cau_scan_integer(scan, what, bytes, 0, INT64_MAX);
	return index;
}

// Reads cells up to version 5.0: number of cells, length of the list; then for each cell its number
// of corners and the corners (int).
static void read_old_list(cau_scan *scan, cell_list *list)
{
	int64_t count = cau_scan_count(scan, "number of cells", 1);
	int64_t length = cau_scan_count(scan, "length of the list", 1);
	cau_scan_check_count(scan, "number of cells", count, scan->binary ? 4 : 1);
	cau_scan_check_count(scan, "length of the list", length, scan->binary ? 4 : 1);
	if (length < count)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the list is shorter than its number of cells");
	if (scan->status)
		return;
	cau_vtk_start_numbers(scan);
	list->first = cau_mesh_array((size_t)count + 1, sizeof *list->first);
	list->corner = cau_mesh_array((size_t)(length - count), sizeof *list->corner);
	if (!list->first || !list->corner) {
		cau_scan_fail(scan, CAU_NO_MEMORY, "no memory for %lld cells", (long long)count);
		return;
	}
	list->count = count;
	for (int64_t i = 0, used = 0; i < count && !scan->status; i++) {
		int64_t corners = cau_scan_integer(scan, "number of corners", 4, 0, length - count - used);
		for (int64_t c = 0; c < corners && !scan->status; c++)
			list->corner[used + c] = cau_scan_integer(scan, "a point", 4, 0, INT32_MAX);
		used += corners;
		list->first[i + 1] = used;
	}
}

// Reads an announced array of whole numbers, from version 5.1 on: its name, type and numbers.
static int64_t *read_named_indices(cau_scan *scan, const char *name, int64_t count)
{
	cau_scan_expect(scan, name);
	const cau_vtk_type *type = cau_vtk_read_type(scan);
	if (type && (type->kind == CAU_VTK_REAL || type->bytes < 4))
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "%s must not have the type %s", name, type->name);
	cau_vtk_start_numbers(scan);
	return read_indices(scan, name, count, type ? type->bytes : 4);
}

// Reads cells from version 5.1 on: number of offsets, number of corners, the offsets, the corners.
static void read_new_list(cau_scan *scan, cell_list *list)
{
	int64_t offset_count = cau_scan_count(scan, "number of offsets", 1);
	int64_t corner_count = cau_scan_count(scan, "number of corners", 1);
	list->first = read_named_indices(scan, "OFFSETS", offset_count);
	list->corner = read_named_indices(scan, "CONNECTIVITY", corner_count);
	if (scan->status || offset_count == 0)
		return;
	bool ordered = list->first[0] == 0 && list->first[offset_count - 1] <= corner_count;
	for (int64_t i = 1; i < offset_count; i++)
		ordered = ordered && list->first[i - 1] <= list->first[i];
	if (!ordered)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "OFFSETS must ascend from 0 to the number of corners");
	list->count = ordered ? offset_count - 1 : 0;
}

static cell_list read_list(cau_vtk *vtk)
{
	cell_list list = {0};
	if (vtk->offsets)
		read_new_list(vtk->scan, &list);
	else
		read_old_list(vtk->scan, &list);
	if (!vtk->scan->status && list.count > CAU_MESH_MAX_ELEMENTS - vtk->cell_count)
		cau_scan_fail(vtk->scan, CAU_LIMIT, "more cells than a mesh may have");
	if (vtk->scan->status)
		finish_list(&list);
	return list;
}

void cau_vtk_read_polygons(cau_vtk *vtk, int type)
{
	cell_list list = read_list(vtk);
	CAU_ASSERT(list.count >= 0, "%lld polygons", (long long)list.count);
	for (int64_t i = 0; i < list.count && !vtk->scan->status; i++)
		cau_vtk_add_cell(vtk->builder, type, list.corner + list.first[i],
		                 list.first[i + 1] - list.first[i], vtk->cell_count++);
	finish_list(&list);
}

void cau_vtk_read_other_cells(cau_vtk *vtk, const char *kind)
{
	CAU_ASSERT(vtk->cell_count >= 0, "%d cells", vtk->cell_count);
	cell_list list = read_list(vtk);
	cau_mesh_builder_skip(vtk->builder, kind, list.count);
	vtk->cell_count += (int32_t)list.count;
	finish_list(&list);
}

void cau_vtk_read_cells(cau_vtk *vtk)
{
	if (vtk->first)
		cau_scan_fail(vtk->scan, CAU_BAD_SYNTAX, "the file has two sections CELLS");
	cell_list list = read_list(vtk);
	if (vtk->scan->status)
		return;
	vtk->first = list.first;
	vtk->corner = list.corner;
	vtk->waiting_count = list.count;
}

void cau_vtk_read_cell_types(cau_vtk *vtk)
{
	cau_scan *scan = vtk->scan;
	int64_t count = cau_scan_count(scan, "number of cell types", 1);
	bool fits = vtk->first && count == vtk->waiting_count;
	if (!fits)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file has %lld CELL_TYPES for %lld CELLS",
		              (long long)count, (long long)vtk->waiting_count);
	cau_vtk_start_numbers(scan);
	for (int64_t i = 0; fits && i < count && !scan->status; i++) {
		int64_t type = cau_scan_integer(scan, "a type of cell", 4, 0, 255);
		if (!scan->status)
			cau_vtk_add_cell(vtk->builder, type, vtk->corner + vtk->first[i],
			                 vtk->first[i + 1] - vtk->first[i], vtk->cell_count++);
	}
	free(vtk->first);
	free(vtk->corner);
	vtk->first = vtk->corner = NULL;
	vtk->waiting_count = 0;
}
