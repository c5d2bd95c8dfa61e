// SPDX-License-Identifier: GPL-3.0-or-later
// Reads legacy VTK. Format: "VTK File Formats", simple legacy formats. Of the attributes only the
// region of the cells is kept. All failures go to the scan.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"
#include "mesh/mesh_builder.h"
#include "mesh/vtk.h"

typedef struct vtk_file {
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
} vtk_file;

// A type of numbers that the format names.
typedef struct number_type {
	const char *name;
	int bytes;
	enum { WHOLE, WHOLE_UNSIGNED, REAL } kind;
} number_type;

// Types of numbers by their names.
// clang-format off
static const number_type types[] = {
	{"double", 8, REAL},
	{"float", 4, REAL},
	{"int", 4, WHOLE},
	{"unsigned_int", 4, WHOLE_UNSIGNED},
	{"long", 8, WHOLE},
	{"unsigned_long", 8, WHOLE_UNSIGNED},
	{"vtktypeint64", 8, WHOLE},
	{"vtktypeuint64", 8, WHOLE_UNSIGNED},
	{"vtktypeint32", 4, WHOLE},
	{"vtkIdType", 4, WHOLE},
	{"short", 2, WHOLE},
	{"unsigned_short", 2, WHOLE_UNSIGNED},
	{"char", 1, WHOLE},
	{"signed_char", 1, WHOLE},
	{"unsigned_char", 1, WHOLE_UNSIGNED},
};
// clang-format on

// Reads the name of a type. Returns NULL if the type is unknown; the scan has then failed.
static const number_type *read_type(cau_scan *scan)
{
	cau_word word = cau_scan_word(scan);
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
		if (cau_word_is(word, types[i].name))
			return &types[i];
	cau_scan_fail(scan, CAU_UNSUPPORTED, "numbers of type '%.*s'",
	              (int)(word.length < 24 ? word.length : 24), word.length ? word.text : "");
	return NULL;
}

// Reads one number of a type.
static double read_number(cau_scan *scan, const number_type *type, const char *what)
{
	if (scan->status)
		return 0;
	if (type->kind == REAL)
		return cau_scan_real(scan, what, type->bytes);
	double number = (double)cau_scan_integer(scan, what, type->bytes, INT64_MIN, INT64_MAX);
	return type->kind == WHOLE_UNSIGNED && number < 0 ? number + ldexp(1, 8 * type->bytes) : number;
}

// Moves to the start of binary numbers: the line after the words that announce them.
static void start_numbers(cau_scan *scan)
{
	if (scan->binary)
		cau_scan_skip_line(scan);
}

// Begins CELL_DATA or POINT_DATA. Returns how many items follow.
static int64_t read_data_count(vtk_file *vtk)
{
	return cau_scan_text_integer(vtk->scan, "number of items", 0, INT32_MAX);
}

// Skips `count` numbers.
static void skip_numbers(cau_scan *scan, const number_type *type, int64_t count)
{
	start_numbers(scan);
	CAU_ASSERT(scan->status || type, "%lld numbers of no type", (long long)count);
	if (scan->status)
		return;
	cau_scan_check_count(scan, "number of values", count, scan->binary ? type->bytes : 1);
	if (scan->binary) {
		if (!scan->status)
			cau_scan_skip(scan, count * type->bytes);
		return;
	}
	for (int64_t i = 0; i < count && !scan->status; i++)
		cau_scan_word_real(scan, cau_scan_word(scan), "a value");
}

// Reads the region of each cell.
static void read_regions(vtk_file *vtk, const number_type *type, int64_t count)
{
	CAU_ASSERT(count >= 0, "%lld regions", (long long)count);
	cau_scan *scan = vtk->scan;
	start_numbers(scan);
	if (scan->status)
		return;
	cau_scan_check_count(scan, "number of values", count, scan->binary ? type->bytes : 1);
	if (vtk->cell_region)
		cau_scan_fail(scan, CAU_BAD_MESH, "the cells have two arrays of regions");
	if (scan->status)
		return;
	vtk->cell_region = cau_mesh_array((size_t)count, sizeof *vtk->cell_region);
	if (!vtk->cell_region) {
		cau_scan_fail(scan, CAU_NO_MEMORY, "no memory for %lld regions", (long long)count);
		return;
	}
	vtk->region_count = count;
	for (int64_t i = 0; i < count && !scan->status; i++) {
		double region = read_number(scan, type, "a region");
		if (!(fabs(region) <= INT32_MAX) || region != floor(region)) {
			cau_scan_fail(scan, CAU_BAD_MESH, "cell %lld: a region must be a whole number",
			              (long long)i);
			return;
		}
		vtk->cell_region[i] = (int32_t)region;
	}
}

// Reads an array of `count` items with `components` numbers each.
static void read_array(vtk_file *vtk, cau_word name, const number_type *type, int64_t count,
                       int64_t components, bool cells)
{
	if (vtk->scan->status)
		return;
	if (components > INT32_MAX || count > INT32_MAX)
		cau_scan_fail(vtk->scan, CAU_BAD_SYNTAX,
		              "an array has %lld items with %lld numbers each; both are at most %d",
		              (long long)count, (long long)components, INT32_MAX);
	else if (cells && components == 1 && cau_vtk_is_region_name(name))
		read_regions(vtk, type, count);
	else
		skip_numbers(vtk->scan, type, count * components);
}

// Reads SCALARS: name type [components], LOOKUP_TABLE name, values.
static void read_scalars(vtk_file *vtk, int64_t count, bool cells)
{
	cau_scan *scan = vtk->scan;
	cau_word name = cau_scan_word(scan);
	const number_type *type = read_type(scan);
	cau_word word = cau_scan_word_of_line(scan);
	int64_t components =
		word.length ? cau_scan_word_integer(scan, word, "number of components", 1, 4) : 1;
	if (cau_word_is(cau_scan_peek(scan), "LOOKUP_TABLE")) {
		cau_scan_word(scan);
		cau_scan_word(scan);
	}
	read_array(vtk, name, type, count, components, cells);
}

// Reads FIELD: name number-of-arrays, then for each array: name, components, items, type, values.
static void read_field(vtk_file *vtk, int64_t item_count, bool cells)
{
	cau_scan *scan = vtk->scan;
	cau_scan_word(scan);
	int64_t array_count = cau_scan_count(scan, "number of arrays", 1);
	for (int64_t i = 0; i < array_count && !scan->status; i++) {
		cau_word name = cau_scan_word(scan);
		int64_t components = cau_scan_text_integer(scan, "number of components", 0, INT32_MAX);
		int64_t count = cau_scan_text_integer(scan, "number of items", 0, INT32_MAX);
		const number_type *type = read_type(scan);
		read_array(vtk, name, type, count, components, cells && count == item_count);
		if (cau_word_is(cau_scan_peek(scan), "METADATA")) {
			do
				cau_scan_skip_line(scan);
			while (cau_scan_word_of_line(scan).length);
		}
	}
}

// Skips colours. They are bytes in a binary file, and fractions in a text.
static void skip_colours(cau_scan *scan, int64_t count, int64_t components)
{
	static const number_type byte = {"unsigned_char", 1, WHOLE_UNSIGNED};
	if (!scan->status)
		skip_numbers(scan, &byte, count * components);
}

// Skips vectors: name; number of components (only TEXTURE_COORDINATES); type; values.
static void skip_vectors(vtk_file *vtk, int64_t count, int64_t components)
{
	cau_scan *scan = vtk->scan;
	cau_word name = cau_scan_word(scan);
	if (!components)
		components = cau_scan_text_integer(scan, "number of components", 1, 3);
	const number_type *type = read_type(scan);
	read_array(vtk, name, type, count, components, false);
}

// Reads the attribute with this keyword. If `cells`, the attribute may be the region of cells.
// Returns false if the keyword is unknown.
static bool read_attribute(vtk_file *vtk, cau_word keyword, int64_t item_count, bool cells)
{
	cau_scan *scan = vtk->scan;
	if (cau_word_is(keyword, "SCALARS")) {
		read_scalars(vtk, item_count, cells);
	} else if (cau_word_is(keyword, "FIELD")) {
		read_field(vtk, item_count, cells);
	} else if (cau_word_is(keyword, "VECTORS") || cau_word_is(keyword, "NORMALS")) {
		skip_vectors(vtk, item_count, 3);
	} else if (cau_word_is(keyword, "TENSORS")) {
		skip_vectors(vtk, item_count, 9);
	} else if (cau_word_is(keyword, "TEXTURE_COORDINATES")) {
		skip_vectors(vtk, item_count, 0);
	} else if (cau_word_is(keyword, "GLOBAL_IDS") || cau_word_is(keyword, "PEDIGREE_IDS")) {
		skip_vectors(vtk, item_count, 1);
	} else if (cau_word_is(keyword, "COLOR_SCALARS")) {
		cau_scan_word(scan);
		skip_colours(scan, item_count, cau_scan_text_integer(scan, "number of values", 1, 4));
	} else if (cau_word_is(keyword, "LOOKUP_TABLE")) {
		cau_scan_word(scan);
		skip_colours(scan, cau_scan_text_integer(scan, "number of colours", 0, INT32_MAX), 4);
	} else {
		return false;
	}
	return true;
}

// ---- points and cells
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

static void read_points(vtk_file *vtk)
{
	cau_scan *scan = vtk->scan;
	if (vtk->has_points)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file has two sections POINTS");
	vtk->has_points = true;
	int64_t count = cau_scan_count(scan, "number of points", 3);
	const number_type *type = read_type(scan);
	start_numbers(scan);
	for (int64_t i = 0; i < count && !scan->status; i++) {
		double position[3];
		for (int c = 0; c < 3; c++)
			position[c] = read_number(scan, type, "a coordinate");
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
	start_numbers(scan);
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
	const number_type *type = read_type(scan);
	if (type && (type->kind == REAL || type->bytes < 4))
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "%s must not have the type %s", name, type->name);
	start_numbers(scan);
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

static cell_list read_list(vtk_file *vtk)
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

// Reads POLYGONS or TRIANGLE_STRIPS of POLYDATA.
static void read_polygons(vtk_file *vtk, int type)
{
	cell_list list = read_list(vtk);
	CAU_ASSERT(list.count >= 0, "%lld polygons", (long long)list.count);
	for (int64_t i = 0; i < list.count && !vtk->scan->status; i++)
		cau_vtk_add_cell(vtk->builder, type, list.corner + list.first[i],
		                 list.first[i + 1] - list.first[i], vtk->cell_count++);
	finish_list(&list);
}

// Counts the other cells of POLYDATA.
static void read_other_cells(vtk_file *vtk, const char *kind)
{
	CAU_ASSERT(vtk->cell_count >= 0, "%d cells", vtk->cell_count);
	cell_list list = read_list(vtk);
	cau_mesh_builder_skip(vtk->builder, kind, list.count);
	vtk->cell_count += (int32_t)list.count;
	finish_list(&list);
}

// Reads CELLS of an unstructured grid. CELL_TYPES must follow.
static void read_cells(vtk_file *vtk)
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

// Reads CELL_TYPES and adds the cells that CELLS announced.
static void read_cell_types(vtk_file *vtk)
{
	cau_scan *scan = vtk->scan;
	int64_t count = cau_scan_count(scan, "number of cell types", 1);
	bool fits = vtk->first && count == vtk->waiting_count;
	if (!fits)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file has %lld CELL_TYPES for %lld CELLS",
		              (long long)count, (long long)vtk->waiting_count);
	start_numbers(scan);
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

// ---- the header and the loop over the sections
// Reads four lines: version, title, ASCII or BINARY, and the kind of DATASET.
static void read_header(vtk_file *vtk)
{
	static const char *const start[] = {"#", "vtk", "DataFile", "Version"};
	cau_scan *scan = vtk->scan;
	for (size_t i = 0; i < sizeof start / sizeof start[0]; i++)
		cau_scan_expect(scan, start[i]);
	double version = cau_scan_word_real(scan, cau_scan_word(scan), "a version");
	vtk->offsets = version > 5.05;
	cau_scan_skip_line(scan);
	cau_scan_skip_line(scan);
	cau_word form = cau_scan_word(scan);
	bool binary = cau_word_is(form, "BINARY");
	if (!binary && !cau_word_is(form, "ASCII"))
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected ASCII or BINARY");
	cau_scan_expect(scan, "DATASET");
	cau_word kind = cau_scan_word(scan);
	if (!cau_word_is(kind, "UNSTRUCTURED_GRID") && !cau_word_is(kind, "POLYDATA"))
		cau_scan_fail(scan, CAU_UNSUPPORTED, "only UNSTRUCTURED_GRID and POLYDATA are read");
	snprintf(vtk->builder->report.format, sizeof vtk->builder->report.format, "VTK %.1f%s", version,
	         binary ? " binary" : "");
	scan->binary = binary;
	scan->swap = binary && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__; // numbers are big-endian
}

// Skips METADATA, which end with an empty line.
static void skip_metadata(cau_scan *scan)
{
	do
		cau_scan_skip_line(scan);
	while (cau_scan_word_of_line(scan).length);
}

// Reads a section of geometry. Returns false if the keyword names no such section.
static bool read_geometry(vtk_file *vtk, cau_word keyword)
{
	if (cau_word_is(keyword, "POINTS"))
		read_points(vtk);
	else if (cau_word_is(keyword, "CELLS"))
		read_cells(vtk);
	else if (cau_word_is(keyword, "CELL_TYPES"))
		read_cell_types(vtk);
	else if (cau_word_is(keyword, "POLYGONS"))
		read_polygons(vtk, CAU_VTK_POLYGON);
	else if (cau_word_is(keyword, "VERTICES"))
		read_other_cells(vtk, "points");
	else if (cau_word_is(keyword, "LINES"))
		read_other_cells(vtk, "lines");
	else if (cau_word_is(keyword, "TRIANGLE_STRIPS"))
		read_polygons(vtk, CAU_VTK_STRIP);
	else
		return false;
	return true;
}

static void read_sections(vtk_file *vtk)
{
	cau_scan *scan = vtk->scan;
	int64_t item_count = 0;
	bool cells = false;
	for (cau_word word = cau_scan_word(scan); word.length; word = cau_scan_word(scan)) {
		if (cau_word_is(word, "CELL_DATA") || cau_word_is(word, "POINT_DATA")) {
			cells = cau_word_is(word, "CELL_DATA");
			item_count = read_data_count(vtk);
		} else if (cau_word_is(word, "METADATA")) {
			skip_metadata(scan);
		} else if (!read_geometry(vtk, word) && !read_attribute(vtk, word, item_count, cells)) {
			cau_scan_fail(scan, CAU_BAD_SYNTAX, "'%.*s' is not the name of a section that is read",
			              (int)(word.length < 24 ? word.length : 24), word.text);
		}
	}
}

cau_status cau_mesh_read_vtk(cau_mesh_builder *builder)
{
	vtk_file vtk = {.scan = builder->scan, .builder = builder};
	read_header(&vtk);
	read_sections(&vtk);
	if (vtk.first)
		cau_scan_fail(vtk.scan, CAU_BAD_SYNTAX, "CELLS without CELL_TYPES");
	cau_mesh_builder_map_regions(builder, vtk.cell_region, vtk.region_count);
	free(vtk.corner);
	free(vtk.first);
	free(vtk.cell_region);
	return builder->scan->status;
}
